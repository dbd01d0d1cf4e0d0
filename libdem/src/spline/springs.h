#pragma once
// The springs of the terrain spline: an energy of squared differences with free boundaries, and the
// 25-point stencil of its gradient. Private to the library.

#include <array>
#include <vector>

#include "dem/raster.h"

namespace dem::spline {

/// Weights c[i][j] of ||Dx^i Dy^j z||^2, 1 <= i + j <= 3. Dx and Dy are forward differences; only
/// differences that lie wholly inside the grid are summed.
struct Springs {
  std::array<std::array<double, 4>, 4> c{};
};

/// The springs whose symbol is a1 K + a2 K^2 + a3 K^3, K = X gx' + gy', g' = g + g^2 / 12,
/// g = 2 - 2 cos k, cut at order 3; X = (dy / dx)^2. Not `fourth_order`: g' = g.
Springs terrain_springs(double a1, double a2, double a3, double X, bool fourth_order = true);

/// The same energy on a grid whose cells are hx columns wide and hy rows high.
Springs coarsen(const Springs& springs, double hx, double hy);

/// The diamond of radius 3, in the order of the tables below:
///        .
///       ...
///      .....
///     .......
///      .....
///       ...
///        .
struct Offset {
  int dx, dy;
};
constexpr int diamond_points = 25;
constexpr std::array<Offset, diamond_points> diamond = [] {
  std::array<Offset, diamond_points> points{};
  std::size_t n = 0;
  for (int dy = -3; dy <= 3; ++dy)
    for (int dx = -3; dx <= 3; ++dx)
      if ((dx < 0 ? -dx : dx) + (dy < 0 ? -dy : dy) <= 3) points[n++] = {dx, dy};
  return points;
}();

/// One row of the gradient: its stencil on interior columns, and lane by lane on the four columns
/// at either end (the right four start at column `right_begin`; lanes off the grid are 0).
template <class T>
struct RowStencil {
  T mid[7][4];  ///< [dy + 3][|dx|]
  T left[diamond_points][4];
  T right[diamond_points][4];
};

/// Where the right four columns start.
constexpr int right_begin(int cols) { return cols < 8 ? 4 : cols - 4; }

/// The matrix A of z^T A z = E(z).
class Stencil {
 public:
  Stencil() = default;
  Stencil(const Springs& springs, Size size);

  /// The entry of A between cells (x, y) and (x + dx, y + dy).
  double at(int x, int y, int dx, int dy) const;
  double diagonal(int x, int y) const { return at(x, y, 0, 0); }

  /// The largest value of A's symbol divided by its diagonal, in the interior.
  double largest_eigenvalue() const;
  double interior_diagonal() const;

  const RowStencil<float>& row(int y) const { return rows_[row_class(y)]; }
  const RowStencil<double>& exact_row(int y) const { return exact_rows_[row_class(y)]; }

 private:
  std::size_t row_class(int y) const;

  Springs springs_;
  Size size_;
  std::vector<RowStencil<float>> rows_;
  std::vector<RowStencil<double>> exact_rows_;
};

}  // namespace dem::spline
