#pragma once
// From points or contour lines to a DEM: all steps in one call, for files and for data in memory.

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "dem/gridding.h"
#include "dem/io/lattices.h"
#include "dem/io/point_files.h"
#include "dem/io/polygons.h"

namespace dem {

/// What a DEM is made from.
struct GridInput {
  /// The path of a file ("-": standard input), points, or contour lines.
  std::variant<std::string, Points, std::vector<ContourLine>> elevations{};
  bool contours = false;  ///< the file has contour lines
  /// How the file is read. For data in memory, `crs`, `to_crs` and `nodata` count.
  PointReadOptions read{};
  /// The path of a vector layer ("": none), or lines in the coordinate system `read.crs`; without
  /// one, they are in that of the lattice.
  std::variant<std::string, std::vector<WorldLine>> breaklines{};
};

/// Whether there are contour lines in a file or in memory.
bool has_contours(const GridInput& input);

/// Where the cells of the DEM lie: on another lattice, over bounds, or where the points are.
struct LatticeWish {
  std::optional<Lattice> like{};   ///< this lattice; all other fields are unset
  std::string like_name = "like";  ///< its name in LatticePoints::lattice_from
  std::optional<Bounds> bounds{};  ///< the edges; unset: those of the points
  std::optional<CellSize> cell{};  ///< unset: it follows from the density of the points
  bool nodes = false;              ///< `bounds` are the centres of the outer cells
};

struct GridRequest {
  LatticeWish lattice{};
  BinOptions bin{};
  GriddingOptions gridding{};
  ChosenMethod method;  ///< how the cells without points are filled
  bool fill = true;     ///< false: these cells stay unknown
};

/// Throws std::invalid_argument when parts of a request exclude each other, or a method or one of
/// its settings cannot be used. Reads nothing.
void check(const GridInput& input, const GridRequest& request);

/// The method for an input when none is named: the contour method for contour lines, otherwise the
/// default fill method.
std::string default_grid_method(bool contours);

/// Cells that breaklines separate from all points.
struct ClosedOff {
  std::size_t cells = 0;
  double x = 0, y = 0;  ///< the middle of their box
};

/// Points on a lattice, before the cells between them are filled.
struct LatticePoints {
  PointSource source;
  std::string lattice_from;           ///< where the lattice comes from, in a few words
  Binned binned;                      ///< its DEM is known where there are points
  Dem levels{};                       ///< of contour lines: the level of each cell with a line
  std::vector<ClosedOff> closed_off;  ///< areas by breaklines, row by row of their first cells
};

/// Reads points or contour lines and brings them onto the lattice.
/// Method: contour lines become points so close that a line crosses no cell unnoticed. Each cell
///         with a line has its level, and a height at its centre (LatticePoints::levels, binned).
/// Cost:   points are kept in memory only while the lattice depends on them. Contour lines in files
///         are read three times.
/// Throws: IoError for files, also when none of its points lies on the lattice or no breakline
///         passes between two cells. std::invalid_argument for the same of data in memory, and as
///         check(). Cancelled.
LatticePoints place_points(const GridInput& input, const GridRequest& request, const Run& run = {});

/// Fills the cells between the points by the method of the request.
/// Throws: std::invalid_argument, Cancelled.
Gridded fill_between(LatticePoints& points, const GridRequest& request, const Run& run = {});

/// A DEM from points.
struct GridResult {
  Dem dem;               ///< whole, unless the request leaves the cells between points unknown
  Raster<float> sigma;   ///< standard error in metres; empty when the method gives none
  LatticePoints points;  ///< what was read; its heights have moved to `dem`
  Misfit misfit;
  std::vector<Figure> report;
  bool contour_lines = false;  ///< as Filled::contour_lines
};

/// Makes a DEM from points or contour lines: place_points, then fill_between.
/// Throws: as these do.
GridResult grid_points(const GridInput& input, const GridRequest& request, const Run& run = {});

}  // namespace dem
