#pragma once
// Elevations on contour lines, and the surface between the lines.

#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

struct ContourOptions {
  /// The least distance of the surface from its contour lines, as a part of the straight slope from
  /// line to line. With 0 the surface only stays between the lines.
  double least_slope = 0.65;
  /// Number of times that the surface is computed again, with cells held that had left their
  /// bounds.
  int rounds = 4;
};
std::vector<Field> fields(ContourOptions& options);

/// What the contour lines say about the cells between them.
struct ContourBounds {
  bool lines = false;               ///< whether the known cells are contour lines at all
  Raster<float> lower, upper;       ///< infinite where unbounded; the level itself on lines
  std::size_t between = 0;          ///< cells between two levels
  std::size_t domes = 0, pits = 0;  ///< areas above (below) all lines around them
};

/// Bounds of the unknown cells of a DEM whose known cells are contour lines.
/// Method: connected unknown cells form an area (four neighbours; lines and breaks enclose it). A
///         cell between two levels lies above the lower one and below the upper one, by least_slope
///         times the straight slope there (distances within the area, chamfer 5-7). An area next to
///         one level only is a hill or a pit, depending on the ground beyond that line: its flank
///         continues, becomes flatter, and stays within the next level. Other areas have no bounds.
///         Known cells are contour lines when they lie along lines, and at least 6 % of the unknown
///         cells lie in areas of at least 20 cells that are next to one or two levels.
ContourBounds contour_bounds(const Dem& dem, const ContourOptions& options = {},
                             const Run& run = {});

/// Fills every unknown cell between contour lines, without terraces.
/// Method: fill_spline. Where its surface leaves contour_bounds, the worst cell of each
///         neighbourhood is held on its bound, and the spline is solved again, `rounds` times.
///         Cells that are still outside are clamped. Cells of lines pull the surface with a nugget,
///         because they lie up to half a cell away from their line.
/// Gives:  known cells bit for bit; all others within their bounds. When the known cells are not
///         contour lines, the result is that of the spline, and Filled::contour_lines is false.
///         The report has contour_lines (1 or 0), cells_held and cells_clamped.
/// Cost:   that of 1 + rounds splines.
/// Throws: std::invalid_argument, Cancelled.
Filled fill_contours(const Dem& dem, const ContourOptions& options = {}, const Run& run = {});

/// The same for line cells that have the height of their centre, which lies away from the line.
/// `at_centres` has these heights and the size of the DEM. They are returned unchanged. The levels
/// of `lines` give the bounds.
Filled fill_contours(const Dem& lines, const Raster<float>& at_centres,
                     const ContourOptions& options, const Run& run = {});

}  // namespace dem
