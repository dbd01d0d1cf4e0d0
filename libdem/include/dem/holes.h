#pragma once
// The voids of a DEM (connected groups of unknown cells, eight neighbours): their inventory, and
// filling them one by one, each in a window of its own.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dem/dem.h"
#include "dem/raster.h"
#include "dem/run.h"

namespace dem {

struct VoidSummary {
  std::size_t cells = 0;         ///< unknown cells
  std::size_t voids = 0;         ///< connected groups of them
  std::size_t largest = 0;       ///< cells of the largest void
  std::size_t border_voids = 0;  ///< voids that touch the rim of the raster
  std::size_t border_cells = 0;  ///< their cells
};

/// Counts the voids of a mask.
/// Method: runs of unknown cells, joined from row to row by union-find.
/// Cost:   O(cells); memory for the runs only.
VoidSummary void_summary(const Mask& known);

/// The unknown cells of those voids that do not touch the rim of the raster: 1 there, 0 elsewhere.
Mask inner_voids(const Mask& known);

// ---- The inventory

/// Cells [begin, end) of one row.
struct CellRun {
  int row = 0, begin = 0, end = 0;
  bool operator==(const CellRun&) const = default;
};

/// One void. Its name is its first cell: row box.row, column first_col.
struct Hole {
  Box box;
  int first_col = 0;
  std::size_t cells = 0;
  std::size_t marked_cells = 0;  ///< those among the cells that were marked for the scan
  double area_m2 = 0;
  double distance_m = 0;   ///< greatest distance of a cell to the nearest known cell
  bool at_border = false;  ///< touches the rim of the raster
  bool has_rim = false;    ///< false when nothing known lies beside it
  double rim_low_m = 0, rim_high_m = 0, rim_mean_m = 0;  ///< heights of the known cells beside it

  double rim_relief_m() const { return rim_high_m - rim_low_m; }
};

/// Finds the holes of a raster that passes row by row.
/// Method:  runs of unknown cells, joined by union-find; a hole is complete, and its distances are
///          taken (exact, in metric cells), when a row no longer touches it.
/// Gives:   holes ordered by row and column of their first cells.
/// Cost:    O(cells) time; memory for two rows, the runs of open holes, and the box of the hole
///          being completed (16 M cells at most: larger boxes are measured in coarser cells).
class HoleScanner {
 public:
  /// `spacing`: of each row of the raster.
  HoleScanner(int cols, std::vector<Spacing> spacing);
  ~HoleScanner();
  HoleScanner(HoleScanner&&) noexcept;
  HoleScanner& operator=(HoleScanner&&) noexcept;

  /// The next row. `marked` (may be empty): cells of a region, counted in Hole::marked_cells.
  void add_row(std::span<const std::uint8_t> known, std::span<const float> z,
               std::span<const std::uint8_t> marked = {});

  /// After the last row. Throws std::logic_error when rows are missing.
  std::vector<Hole> finish();

 private:
  class Scan;
  std::unique_ptr<Scan> scan_;
};

/// The holes of a DEM. `spacing`: of each row, or empty: that of the DEM everywhere.
std::vector<Hole> find_holes(const Dem& dem, std::vector<Spacing> spacing = {},
                             const Mask& marked = {});

/// The cells of some holes in a part of the raster that holds all of them; (col, row) is the first
/// cell of each there.
struct FirstCell {
  int col = 0, row = 0;
};
std::vector<std::vector<CellRun>> cells_of_holes(const Mask& known,
                                                 const std::vector<FirstCell>& holes);

/// A condition on a hole in words: comparisons of numbers and the names of hole_facts(), joined by
/// `and`, `or`, `not` and brackets; + - * / on numbers. "area_km2 < 5 and not at_border".
/// Throws std::invalid_argument that shows where it is wrong.
std::function<bool(const Hole&)> parse_hole_filter(std::string_view text);

/// What is known of a hole, by name: area_km2, cells, distance_m, rim_relief_m ...
struct HoleFact {
  std::string name, doc;
  std::function<double(const Hole&)> value;
};
const std::vector<HoleFact>& hole_facts();

// ---- Filling hole by hole

/// Holes that are filled together, and the part of the raster that is looked at for it.
struct HoleWindow {
  Box box;
  std::vector<std::uint32_t> holes;  ///< numbers in the list of holes
};

/// A window for each of the chosen holes.
/// Method: a hole's own window is its box and a margin of 6 cells plus its greatest distance to
///         data, clipped to the raster. A hole whose window lies inside that of a larger hole is
///         filled there. Small ones (at most 32 cells wide and high) that lie in the same square of
///         64 x 64 cells share a window. `origin`: column and row of the first cell in a lattice
///         that all cuts of a raster have in common; the squares belong to that lattice.
/// Gives:  windows that depend on the holes in and beside them only, in the order of their rows.
/// `chosen`: one flag a hole.
struct LatticeOrigin {
  std::int64_t col = 0, row = 0;
};
std::vector<HoleWindow> plan_windows(const std::vector<Hole>& holes,
                                     const std::vector<std::uint8_t>& chosen, Size raster,
                                     LatticeOrigin origin = {});

/// Where the height of a cell comes from.
enum class CellOrigin : std::uint8_t { measured = 0, method = 1, guide = 2, water = 3, left = 4 };

/// What is known of one box of the raster.
struct WindowData {
  Dem dem;                    ///< its spacing is that of the box's middle row
  std::vector<Dem> guides{};  ///< other DEMs on the same cells, with holes of their own
  Mask water{};               ///< cells of water; empty: none are known
};

/// What was put into the holes of one window. The vectors "of each hole" follow `holes`.
struct HolePatch {
  std::size_t window = 0;              ///< number in the list of windows
  std::vector<std::uint32_t> holes;    ///< as in the window
  std::vector<std::size_t> first_run;  ///< of each hole, and the end of the last
  std::vector<int> guide;              ///< of each hole: the guide taken, or -1
  std::vector<float> rim_error_m;      ///< of each hole: RMSE of hidden rim cells, or NaN
  std::vector<float> offset_m;         ///< of each hole: mean height above the guide, or NaN
  std::vector<CellRun> runs;           ///< in cells of the raster
  std::vector<float> z, sigma;         ///< of the runs' cells, in order; sigma may be empty
  std::vector<CellOrigin> origin;      ///< of the runs' cells
  /// Of each hole: how many cells come from method, guide, water, and how many are left.
  std::vector<std::array<std::uint64_t, 4>> cells_by_origin;
  std::vector<Figure> report;  ///< what the method says of the window
  bool contour_lines = false;  ///< the method found contour lines in the window
  double seconds = 0;
};

/// How windows are read, filled and taken.
struct HoleWork {
  std::function<WindowData(const Box&)> read;
  /// Fills all unknown cells of a window, on one thread or many.
  std::function<Filled(const Dem&, const Run&)> fill;
  /// Takes what was filled, in the order of the windows.
  std::function<void(HolePatch&&)> take;
  bool flat_water = false;  ///< fill holes with a flat rim (HoleWork::is_flat) flat
  bool rim_errors = false;  ///< hide rim cells and see how well they are found: a second fill
  std::size_t memory_cells = std::size_t(-1);  ///< of windows worked on at once (one always is)

  /// Whether a hole is water: all known cells beside it have one height, to a centimetre, and it is
  /// at least 4 cells.
  static bool is_flat(const Hole& hole);
};

/// Fills the holes window by window: small windows side by side, large ones one after another on
/// all threads. `read` and `take` are called from the calling thread only.
/// Guides:  the method fills z - guide instead of z (a delta surface), and the guide is added
///          again: no step at the rim, no bias. Each hole takes the guide, or none, that finds
///          hidden rim cells best; a guide that does not cover the hole is not asked.
/// Water:   cells of water in a hole lie flat, at a tenth of the known heights beside them (the
///          lowest rim of the hole where none is); their shore stays above.
/// Throws:  what the three throw, Cancelled.
void fill_windows(const std::vector<Hole>& holes, const std::vector<HoleWindow>& windows,
                  const HoleWork& work, const Run& run = {});

/// A sum over the known cells of hashes of place and height: equal before and after when no known
/// cell changed by a bit. Rows may come in any order, and parts be added.
std::uint64_t known_checksum(const Dem& dem);
std::uint64_t known_checksum(int row, std::span<const std::uint8_t> known,
                             std::span<const float> z);

}  // namespace dem
