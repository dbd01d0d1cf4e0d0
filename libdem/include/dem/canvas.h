#pragma once
// Where the cells of a generated terrain lie.

#include <vector>

#include "dem/dem.h"

namespace dem {

/// The cells of a terrain that is to be generated.
struct Canvas {
  Size size{1025, 1025};
  Spacing spacing{30, 30};
  GeoRef ref;

  /// The distance of column `col` east, and of row `row` north, of the CRS's origin, in metres.
  /// A generator uses these places and not the cells. A part of a terrain, or the same terrain with
  /// smaller cells, therefore has the same heights.
  double east_m(int col) const;
  double north_m(int row) const;
};

/// A control point of a ridge that a user drew. Its place is in cells. The foot of the ridge is 2
/// width_m wide.
struct RidgePoint {
  double col = 0, row = 0;
  double height_m = 0, width_m = 0;
};

/// A drawing by a user, from which a generator starts.
struct Drawing {
  Raster<float> grey;  ///< from 0 (black) to 1 (white); it has the size of the canvas
  std::vector<std::vector<RidgePoint>> ridges{};
};

/// Throws std::invalid_argument unless the canvas has 1 to 2^30 cells, a finite spacing above 0 and
/// a georeference whose rows run along x and whose columns run along y.
void check_canvas(const Canvas& canvas);

/// The DEM of generated heights on a canvas. Every cell is known.
Dem on_canvas(const Canvas& canvas, Raster<float> z);

}  // namespace dem
