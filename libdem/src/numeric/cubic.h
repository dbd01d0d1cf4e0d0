#pragma once
// Heights between cells, by cubic convolution. Private to the library.

#include <algorithm>
#include <array>
#include <cmath>

#include "dem/raster.h"

namespace dem::numeric {

/// Weights of four cells in a row, for a place t (0 to 1) between the middle two; exact on
/// quadratics.
inline std::array<double, 4> cubic_weights(double t) {
  return {((2 - t) * t - 1) * t / 2, ((3 * t - 5) * t * t + 2) / 2, ((4 - 3 * t) * t + 1) * t / 2,
          (t - 1) * t * t / 2};
}

/// The surface at a place between cells. Beyond the rim it goes on straight.
inline double cubic_at(const Raster<float>& z, double col, double row) {
  const double c0 = std::floor(col), r0 = std::floor(row);
  const auto wx = cubic_weights(col - c0), wy = cubic_weights(row - r0);
  const auto along_row = [&](int x, int y) {
    const int inside = std::clamp(x, 0, z.cols() - 1);
    const int mirrored = std::clamp(2 * inside - x, 0, z.cols() - 1);
    return 2 * double(z(inside, y)) - double(z(mirrored, y));
  };
  const auto at = [&](int x, int y) {
    const int inside = std::clamp(y, 0, z.rows() - 1);
    const int mirrored = std::clamp(2 * inside - y, 0, z.rows() - 1);
    return 2 * along_row(x, inside) - along_row(x, mirrored);
  };
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += wx[std::size_t(i)] * wy[std::size_t(j)] * at(int(c0) + i - 1, int(r0) + j - 1);
  return sum;
}

}  // namespace dem::numeric
