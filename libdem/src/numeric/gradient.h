#pragma once
// The gradient of a surface in one cell by the 3 x 3 differences of Sobel and Horn. Private to the
// library.

#include <cstdint>
#include <span>

#include "dem/dem.h"

namespace dem::numeric {

/// Metres of height per metre of way, towards east and towards south.
struct Gradient {
  double east = 0;
  double south = 0;

  double squared() const { return east * east + south * south; }
};

/// The gradient where all eight neighbours exist and are known, from the rows above, of and below
/// the cell (1 <= col <= cols - 2).
///
///   1 . -1     each line's difference of its two ends, weighted 1 2 1
///   2 c -2
///   1 . -1
inline Gradient inner_gradient(std::span<const float> above, std::span<const float> here,
                               std::span<const float> below, int col, Spacing cell) {
  const auto w = std::size_t(col) - 1, c = std::size_t(col), e = std::size_t(col) + 1;
  const double nw = above[w], n = above[c], ne = above[e], west = here[w], east = here[e],
               sw = below[w], s = below[c], se = below[e];
  return {((ne - nw) + 2 * (east - west) + (se - sw)) / (8 * cell.dx_m),
          ((sw - nw) + 2 * (s - n) + (se - ne)) / (8 * cell.dy_m)};
}

/// The gradient of any cell: a line that lacks one end takes the difference to its middle, a line
/// that lacks more is left out. `known` may be empty: every cell is known then.
class GradientOf {
 public:
  GradientOf(const Raster<float>& z, const Mask& known, Spacing cell)
      : z_(z), known_(known), cell_(cell) {}

  Gradient operator()(int col, int row) const {
    if (whole(col, row))
      return inner_gradient(z_.row(row - 1), z_.row(row), z_.row(row + 1), col, cell_);
    return {across(col, row, 1, 0) / cell_.dx_m, across(col, row, 0, 1) / cell_.dy_m};
  }

 private:
  bool has(int col, int row) const {
    return z_.contains(col, row) && (known_.empty() || known_(col, row));
  }

  bool whole(int col, int row) const {
    if (col < 1 || row < 1 || col > z_.cols() - 2 || row > z_.rows() - 2) return false;
    if (known_.empty()) return true;
    int n = 0;
    for (int r = row - 1; r <= row + 1; ++r)
      for (int c = col - 1; c <= col + 1; ++c) n += known_(c, r) != 0;
    return n == 9;
  }

  /// Mean difference per cell in the direction (dc, dr), over the three lines side by side.
  double across(int col, int row, int dc, int dr) const {
    double sum = 0;
    int weights = 0;
    for (int side = -1; side <= 1; ++side) {
      const int c = col + side * dr, r = row + side * dc, weight = side == 0 ? 2 : 1;
      const bool before = has(c - dc, r - dr), middle = has(c, r), after = has(c + dc, r + dr);
      if (before + middle + after < 2) continue;
      const double from = before ? z_(c - dc, r - dr) : z_(c, r);
      const double to = after ? z_(c + dc, r + dr) : z_(c, r);
      sum += weight * (to - from) / (before && after ? 2 : 1);
      weights += weight;
    }
    return weights == 0 ? 0 : sum / weights;
  }

  const Raster<float>& z_;
  const Mask& known_;
  Spacing cell_;
};

}  // namespace dem::numeric
