#pragma once
// Elevations on contour lines, and the surface between the lines.

#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

struct ContourOptions {
  /// How far from its contour lines the surface keeps at least: this part of the straight slope
  /// from line to line; 0: it only stays between them.
  double least_slope = 0.65;
  /// So many times the surface is made anew, with cells held that had left their bounds.
  int rounds = 4;
};
std::vector<Field> fields(ContourOptions& options);

/// What the lines say of the cells between them.
struct ContourBounds {
  bool lines = false;               ///< whether the known cells are contour lines at all
  Raster<float> lower, upper;       ///< infinite where nothing is said; the level itself on lines
  std::size_t between = 0;          ///< cells between two levels
  std::size_t domes = 0, pits = 0;  ///< areas above (below) all lines around them
};

/// Bounds of the unknown cells of a DEM whose known cells are contour lines.
/// Method: unknown cells that hang together (four neighbours; lines and breaks are walls) form an area. Between
///         two levels, a cell lies above the lower one and below the upper one, by least_slope times
///         the straight slope there (distances within the area, chamfer 5-7). Beside one level only,
///         the ground beyond that line says whether the area is a hill or a pit: its flank goes on
///         and rounds off, and stays within the next level. Else nothing is said. Known cells are
///         contour lines when they lie along lines, and at least 6 % of the unknown ones lie in areas
///         of 20 cells and more beside one level or two.
ContourBounds contour_bounds(const Dem& dem, const ContourOptions& options = {},
                             const Run& run = {});

/// Fills every unknown cell between contour lines, without terraces.
/// Method:   fill_spline; where it leaves contour_bounds, the worst cell of each neighbourhood is held
///           on its bound, and the spline is solved again, `rounds` times; what is left is clamped.
///           Cells of lines pull the surface with a nugget, as they lie up to half a cell off their
///           line.
/// Gives:    known cells bit for bit; all others within their bounds. Known cells that are no
///           contour lines: the spline, and Filled::contour_lines is false.
/// Cost:     that of 1 + rounds splines.
/// Throws:   std::invalid_argument, Cancelled.
Filled fill_contours(const Dem& dem, const ContourOptions& options = {}, const Run& run = {});

/// The same for lines whose cells have the height of their centre, which lies off the line:
/// `at_centres`, of the size of the DEM. These heights come back; the levels of `lines` give bounds.
Filled fill_contours(const Dem& lines, const Raster<float>& at_centres,
                     const ContourOptions& options, const Run& run = {});

}  // namespace dem
