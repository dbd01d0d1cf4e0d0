#pragma once
// One V-cycle over a hierarchy of grids: the preconditioner of the spline's solver.
// Private to the library.

#include <array>
#include <vector>

#include "spline/cuts.h"
#include "spline/grid.h"
#include "spline/springs.h"

namespace dem::spline {

/// One grid of the hierarchy: the matrix A + diag(w) on its free cells.
struct Level {
  Size size;
  double hx = 1, hy = 1;  ///< size of a cell in cells of the finest grid
  Stencil A;
  Mask breaks;       ///< as Dem::breaks; empty: none
  CutCells cuts;     ///< where A is another than the stencil's
  Grid<float> w;     ///< weight of the data at each cell; empty: no cell has one
  Grid<float> dinv;  ///< 1 / (A's diagonal + w); 0 at cells that are fixed
  Spans spans;
  Grid<float> b, u, s;  ///< right-hand side (not on the finest grid), two iterates

  /// The entry of A between cells (x, y) and (x, y) + diamond[p].
  double entry(int x, int y, int p) const;
};

/// The dense end of the hierarchy: a banded Cholesky factor, rows of the lower triangle.
class BandedFactor {
 public:
  BandedFactor() = default;
  explicit BandedFactor(const Level& level);

  /// x = (A + diag(w))^-1 b on the free cells, 0 elsewhere.
  void solve(const Grid<float>& b, Grid<float>& x) const;

 private:
  double& at(int i, int j) {
    return l_[std::size_t(i) * std::size_t(band_ + 1) + std::size_t(j - i + band_)];
  }
  double at(int i, int j) const {
    return l_[std::size_t(i) * std::size_t(band_ + 1) + std::size_t(j - i + band_)];
  }

  Size size_;
  int band_ = 0;
  std::vector<double> l_;
  std::vector<bool> fixed_;
};

/// One step of a Chebyshev smoother: next = now + a (now - before) + c D^-1 residual.
struct Step {
  float a, c;
};

/// Vertex-centred grids, each about half as fine as the one before, over the same springs.
class Multigrid {
 public:
  /// `free` tells where the finest grid has unknowns. `w`: data weights of its cells, or empty.
  /// `X` is (dy / dx)^2: on long cells one axis is coarsened before the other. `breaks`: as
  /// Dem::breaks; springs and interpolation between grids are cut there.
  Multigrid(const Springs& springs, double X, const Mask& free, Grid<float> w,
            const Mask& breaks = {});

  const Level& finest() const { return levels_.front(); }
  int levels() const { return int(levels_.size()); }

  /// An approximation of (A + diag(w))^-1 b on the free cells; 0 elsewhere. The result stays valid
  /// until the next call.
  const Grid<float>& v_cycle(const Grid<float>& b);

 private:
  void cycle(std::size_t l, const Grid<float>& b);

  std::vector<Level> levels_;
  std::vector<std::vector<Step>> steps_;
  BandedFactor coarsest_;
};

/// Pointers to the rows y - 3 ... y + 3 of a grid; `zero` stands for rows off the grid.
template <class T>
std::array<const T*, 7> rows_around(const Grid<T>& grid, int y, const T* zero) {
  std::array<const T*, 7> rows;
  for (int dy = -3; dy <= 3; ++dy) {
    const bool inside = y + dy >= 0 && y + dy < grid.size().rows;
    rows[std::size_t(dy + 3)] = inside ? grid.row(y + dy) : zero;
  }
  return rows;
}

/// Calls each(x, (A u)(x)) for the free cells of a row whose springs are cut; `u`: rows_around it.
template <class T, class Each>
void for_cut_cells(const Level& level, int y, const T* const* u, const Each& each) {
  for (const CutCell& cell : level.cuts.row(y)) {
    if (level.dinv.row(y)[cell.col] == 0) continue;
    T sum = 0;
    for (std::size_t p = 0; p < std::size_t(diamond_points); ++p)
      sum += T(cell.entry[p]) * u[diamond[p].dy + 3][cell.col + diamond[p].dx];
    each(cell.col, sum);
  }
}

/// out = (A u + w u) where dinv is not 0, else 0; on one span. `w` may be null.
void apply_row(const RowStencil<float>& A, const float* const* u, const float* w, const float* dinv,
               Span span, int cols, float* out);

/// out = f - A x - w x where dinv is not 0, else 0; on one span. `f` and `w` may be null.
void residual_row(const RowStencil<double>& A, const double* const* x, const float* f,
                  const float* w, const float* dinv, Span span, int cols, float* out);

}  // namespace dem::spline
