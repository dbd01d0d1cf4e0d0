#pragma once
// Springs that bend with the terrain: the plate's second differences weighted, cell by cell, by the
// inverse of how the surface around the cell bends. Ridges and valleys then continue through gaps.
// Private to the library.

#include <array>
#include <cstdint>

#include "spline/grid.h"

namespace dem::spline {

/// The difference of the local energy of second order from the plate's, in orthonormal coordinates
/// h = (X zxx, sqrt(2 X) zxy, zyy):  h^T (W - 1) h  for each cell whose 3 x 3 neighbours exist. zxy
/// lives on the cell's four corners; its square is their mean, so that the sum stays positive.
class Tensor {
 public:
  using Weight = std::int16_t;  ///< in steps of 1 / 1000

  /// Weights are kept where they reach a cell of `spans`. X = (dy / dx)^2. Beside `breaks` (as
  /// Dem::breaks; may be empty) the springs stay as they are: W = 1.
  Tensor(Size size, const Spans& spans, double X, const Mask& breaks = {});

  /// Reads the weights off a surface. C = Gauss(h h^T) over `sigma` cells, W = C'^-1 / 3 with
  /// C' = 0.95 C / trace C + 0.05 C_iso, C_iso that of a surface without direction: W = 1 there.
  void estimate(const Grid<double>& z, double sigma);

  /// out += sign * (gradient of half the energy) at u, on free cells (dinv is not 0).
  void add(const Grid<float>& u, float sign, const Grid<float>& dinv, Grid<float>& out) const;
  void add(const Grid<double>& u, float sign, const Grid<float>& dinv, Grid<float>& out) const;

 private:
  template <class T>
  void add_to(const Grid<T>& u, float sign, const Grid<float>& dinv, Grid<float>& out) const;

  Size size_;
  const Spans& spans_;  ///< rows and columns of free cells
  Spans around_;        ///< the same, one cell wider to all sides
  double X_;
  std::vector<std::vector<int>>
      broken_;                     ///< by row: cells with a broken edge in their 3 x 3; empty: none
  std::array<Grid<Weight>, 6> w_;  ///< W - 1: 11, 12, 13, 22, 23, 33; 0 on the rim
};

}  // namespace dem::spline
