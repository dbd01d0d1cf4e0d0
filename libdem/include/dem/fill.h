#pragma once
// Filling the voids of a DEM: the one recipe that the command line, C, Python and clusters share.
//
//   dem::DemFile file = dem::read_dem("N36E008.hgt");
//   dem::HoleFill filled = dem::fill_holes(file.dem);
//
// A void is filled in a window of its own: its surroundings decide, not the rest of the raster.
// Above a quarter of unknown cells the known ones are samples, and the whole raster is one window.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "dem/dem.h"
#include "dem/hole_choice.h"
#include "dem/holes.h"
#include "dem/methods.h"
#include "dem/run.h"

namespace dem {

struct FillOptions {
  ChosenMethod method{};  ///< none: the default method
  HoleChoice holes{};     ///< which voids are filled
  bool whole = false;     ///< one window for the whole raster, however few cells are unknown
  bool sigma = false;     ///< also give the standard error of each filled cell
  bool rim_errors =
      false;  ///< hide known cells beside each void and report how well they are found
};

/// The options with the default method and the setting for sigma put in; `sigma` then says whether
/// the method gives a standard error.
/// Throws std::invalid_argument for a bad setting, a bad condition, or a sigma that the method
/// lacks.
FillOptions checked(FillOptions options);

/// An auxiliary DEM. `read` gives its heights on the cells of a box, unknown where it has none.
struct Guide {
  std::string name;
  std::function<Dem(const Box&)> read;
};

/// What is known besides the raster. The functions are called from one thread at a time.
struct FillLayers {
  std::vector<Guide> guides{};
  std::function<Mask(const Box&)> water{};   ///< 1: lake, flat where it is unknown
  std::function<Mask(const Box&)> region{};  ///< 1: only voids with such a cell are filled
};

/// Voids and the windows that they are filled in.
struct FillPlan {
  std::vector<Hole> holes;
  std::vector<Verdict> verdicts;    ///< of each hole
  std::vector<HoleWindow> windows;  ///< of the holes that are filled
  bool whole = false;               ///< the raster is one window
};

/// What became of one void.
struct HoleOutcome {
  std::size_t method_cells = 0, guide_cells = 0, water_cells = 0, left_cells = 0;
  int guide = -1;                       ///< number of the guide taken; -1: none
  float rim_error_m = 0, offset_m = 0;  ///< NaN: not known
  double seconds = 0;                   ///< of its window, shared by the voids in it
  std::size_t window_cells = 0;         ///< 0: not filled
};

/// How much of the raster a guide covered, and where it seems to lie relative to the raster.
struct GuideFit {
  std::string name;
  std::size_t cells = 0;                  ///< known in both, in the windows
  double offset_m = 0;                    ///< median of (raster - guide)
  double shift_cols = 0, shift_rows = 0;  ///< of the guide, by least squares on the slopes
  std::string warning;                    ///< "" when all seems well
};

struct FillReport {
  std::vector<HoleOutcome> outcomes;                           ///< of each hole of the plan
  std::size_t unknown = 0, filled = 0, left = 0, windows = 0;  ///< cells, cells, cells, windows
  std::size_t resumed_windows = 0;                     ///< those that an earlier run had filled
  std::size_t left_at_border = 0, left_by_choice = 0;  ///< cells; the latter without the former
  std::size_t border_holes = 0, border_cells = 0, water_cells = 0, guide_cells = 0;
  bool known_kept = true;  ///< the checksum of the known cells is what it was
  std::uint64_t known_checksum = 0;
  std::size_t memory_needed = 0;  ///< bytes for the largest window that did not fit; 0: all did
  double seconds = 0;             ///< wall time of the filling
  double window_seconds = 0;      ///< time of all windows, one after another, of this run
  std::vector<Figure> figures;    ///< of the method, when there was one window
  bool contour_lines = false;     ///< the method found contour lines in a window
  std::vector<GuideFit> guides;
};

struct HoleFill {
  Dem dem;              ///< voids that were left are unknown
  Raster<float> sigma;  ///< standard error in metres, 0 at known cells; empty: not asked for
  Raster<std::uint8_t> origin;  ///< CellOrigin of each cell
  FillPlan plan;
  FillReport report;
};

/// Fills the voids of a DEM.
/// Method:  find_holes, plan_windows and fill_windows (dem/holes.h) with a method of the table.
/// Gives:   known cells bit for bit; the same cells as every other door of the library, for any
///          number of threads.
/// Needs:   Dem::row_spacing for cells in degrees (read_dem sets it).
/// Cost:    O(cells) to find the voids, and what the method costs on the windows.
/// Throws:  std::invalid_argument (no known cell, bad settings, no such sigma), Cancelled.
HoleFill fill_holes(Dem dem, const FillOptions& options = {}, const FillLayers& layers = {},
                    const Run& run = {});

// ---- For rasters that are not held in memory (dem/io/fill_job.h)

/// A raster that is read box by box; boxes have a spacing of their own.
struct FillRaster {
  Size size;
  LatticeOrigin origin;
  std::function<Dem(const Box&)> read;
};

/// The column and row of a raster's first cell in the lattice that all cuts of it share.
LatticeOrigin lattice_origin(const GeoRef& ref);

/// Where filled windows are kept.
class FillStore {
 public:
  virtual ~FillStore() = default;
  /// Whether a window is kept here already, by its number in the plan.
  virtual bool has(std::size_t window) const = 0;
  /// The outcomes of such windows, without cells.
  virtual const std::vector<HolePatch>& done() const = 0;
  /// Keeps a window; it is safe when the call returns.
  virtual void add(const HolePatch& patch) = 0;
};

/// Decides which holes are filled, and in which windows. `options` are checked() ones.
FillPlan plan_fill(std::vector<Hole> holes, Size raster, LatticeOrigin origin,
                   const FillOptions& options, bool in_region);

/// Windows [first, end) of a plan.
struct WindowRange {
  std::size_t first = 0, end = std::size_t(-1);
};

/// What a plan says before anything is filled: all that needs no heights.
FillReport report_of(const FillPlan& plan, WindowRange range = {});

/// Fills the windows of a range that the store does not have, and reports on all that it then has.
/// `memory_cells`: of windows worked on at once.
FillReport fill_plan(const FillRaster& raster, const FillPlan& plan, WindowRange range,
                     const FillOptions& options, const FillLayers& layers, FillStore& store,
                     std::size_t memory_cells, const Run& run);

}  // namespace dem
