#include "spline/overshoot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem::spline {
namespace {

struct Bounds {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();

  void take(Bounds other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

/// The bounds of 2 x 2 cells each.
Raster<Bounds> halved(const Raster<Bounds>& fine) {
  Raster<Bounds> coarse(Size{(fine.cols() + 1) / 2, (fine.rows() + 1) / 2});
  for (int row = 0; row < fine.rows(); ++row)
    for (int col = 0; col < fine.cols(); ++col) coarse(col / 2, row / 2).take(fine(col, row));
  return coarse;
}

/// The bounds of a block and of the blocks around it.
Bounds around(const Raster<Bounds>& blocks, int col, int row) {
  Bounds bounds;
  for (int r = std::max(0, row - 1); r <= std::min(blocks.rows() - 1, row + 1); ++r)
    for (int c = std::max(0, col - 1); c <= std::min(blocks.cols() - 1, col + 1); ++c)
      bounds.take(blocks(c, r));
  return bounds;
}

}  // namespace

double overshoot(const Grid<double>& surface, const Mask& known,
                 const Raster<std::uint16_t>& distance) {
  const Size size = known.size();
  Raster<Bounds> blocks(size);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      if (known(col, row)) {
        const float z = float(surface.row(row)[col]);
        blocks(col, row) = {z, z};
      }

  // A cell at distance d looks at blocks of the least side >= d (and >= 2), all at the last level.
  double outside = 0, ranges = 0;
  const int longest = std::max(size.cols, size.rows);
  for (int level = 1, before = 0; before == 0 || before < longest; ++level) {
    const int side = 1 << level;
    blocks = halved(blocks);
    for (int row = 0; row < size.rows; ++row) {
      double row_outside = 0, row_ranges = 0;
      for (int col = 0; col < size.cols; ++col) {
        const int d = distance(col, row);
        if (known(col, row) || d <= 5 * before || (d > 5 * side && side < longest)) continue;
        const Bounds b = around(blocks, col >> level, row >> level);
        const double z = surface.row(row)[col], range = double(b.high) - double(b.low);
        const double out = std::max({0.0, z - double(b.high), double(b.low) - z});
        row_outside += out * out;
        row_ranges += range * range;
      }
      outside += row_outside;
      ranges += row_ranges;
    }
    before = side;
  }
  return ranges > 0 ? std::sqrt(outside / ranges) : 0;
}

}  // namespace dem::spline
