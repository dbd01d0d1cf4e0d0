#pragma once
// Where a terrain that is made from nothing shall lie.

#include <vector>

#include "dem/dem.h"

namespace dem {

/// The cells of a terrain to be made.
struct Canvas {
  Size size{1025, 1025};
  Spacing spacing{30, 30};
  GeoRef ref;

  /// Metres east of the CRS's origin of column `col`, and north of it of row `row`: places, not
  /// cells, so that a part of a terrain, or the same terrain in finer cells, has the same heights.
  double east_m(int col) const;
  double north_m(int row) const;
};

/// A control point of a ridge that a user drew, in cells; the ridge is 2 width_m wide at its foot.
struct RidgePoint {
  double col = 0, row = 0;
  double height_m = 0, width_m = 0;
};

/// What a user drew for a generator to start from.
struct Drawing {
  Raster<float> grey;  ///< levels from 0 (black) to 1 (white); the canvas has its size
  std::vector<std::vector<RidgePoint>> ridges{};
};

/// Throws std::invalid_argument unless the canvas has 1 to 2^30 cells, a finite spacing above 0 and
/// a georeference whose rows run along x and whose columns run along y.
void check_canvas(const Canvas& canvas);

/// The DEM of heights made on a canvas: every cell is known.
Dem on_canvas(const Canvas& canvas, Raster<float> z);

}  // namespace dem
