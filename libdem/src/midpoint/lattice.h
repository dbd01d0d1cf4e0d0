#pragma once
// The midpoint lattice on a raster of any width and height. Private to the library.
//
// On one axis of n nodes, 0 .. last, node i is born with the stride
//     stride(i) = the largest power of two that divides i;   infinite for i = 0 and i = last
// between its two ascendants i - stride and min(i + stride, last). For n = 2^k + 1 this is the
// classical tree of midpoints; for any other n only the last interval of each level is shorter.
//
// In two dimensions, with s = min(stride(x), stride(y)):
//
//     A---e---A     A: older nodes   e: edge, one stride is s, the other larger
//     | \ | / |                      c: centre, both strides are s
//     e---c---e     c's ascendants are the four A; e's are the two A beside it and, in
//     | / | \ |     diamond-square, the centres of the squares on its two sides.
//     A---e---A     Roots (both strides infinite) have none.
//
// No tree is stored: an ascendant is an addition, a stride one count of trailing zeros.

#include <algorithm>
#include <bit>
#include <cmath>

#include "dem/mcmd.h"
#include "dem/raster.h"

namespace dem::midpoint {

/// One axis of the lattice.
struct Axis {
  static constexpr int infinite = 1 << 30;
  static constexpr int none = -1;

  int last = 0;

  int stride(int i) const { return i == 0 || i == last ? infinite : i & -i; }
  int above(int i, int s) const { return std::min(i + s, last); }

  /// The largest finite stride on this axis, 0 when there is none.
  int top_stride() const { return last < 2 ? 0 : int(std::bit_floor(unsigned(last - 1))); }

  // The nodes born at stride s next to node i (stride(i) > s) on either side, or none.
  int child_below(int i, int s) const {
    if (i != last) return i - s > 0 ? i - s : none;
    const int odd = (last - 1) / s;  // the last multiple of s before the far edge
    return odd % 2 == 1 ? odd * s : none;
  }
  int child_above(int i, int s) const { return i + s < last ? i + s : none; }
};

/// The lattice of a raster.
struct Lattice {
  Axis x, y;
  Subdivision subdivision;

  Lattice(Size size, Subdivision how) : x{size.cols - 1}, y{size.rows - 1}, subdivision(how) {}

  bool diamond() const { return subdivision == Subdivision::diamond_square; }
  int top_stride() const { return std::max(x.top_stride(), y.top_stride()); }

  /// Calls f(col, row) for each ascendant of cell (col, row).
  template <class F>
  void for_each_ascendant(int col, int row, F f) const {
    const int sx = x.stride(col), sy = y.stride(row), s = std::min(sx, sy);
    if (s == Axis::infinite) return;
    if (sx == sy) {
      const int right = x.above(col, s), down = y.above(row, s);
      f(col - s, row - s), f(right, row - s), f(col - s, down), f(right, down);
    } else if (sx == s) {
      f(col - s, row), f(x.above(col, s), row);
      if (diamond()) on_both_sides(y, row, s, [&](int centre) { f(col, centre); });
    } else {
      f(col, row - s), f(col, y.above(row, s));
      if (diamond()) on_both_sides(x, col, s, [&](int centre) { f(centre, row); });
    }
  }

  /// Calls f(col, row) for each cell that has (col, row) among its ascendants.
  template <class F>
  void for_each_child(int col, int row, F f) const {
    const int sx = x.stride(col), sy = y.stride(row), born = std::min(sx, sy);
    for (int s = 1; s < born && s <= top_stride(); s *= 2) {
      const int left = x.child_below(col, s), right = x.child_above(col, s);
      const int up = y.child_below(row, s), down = y.child_above(row, s);
      for (int v : {up, down}) {
        if (v == Axis::none) continue;
        if (left != Axis::none) f(left, v);
        if (right != Axis::none) f(right, v);
        f(col, v);
      }
      if (left != Axis::none) f(left, row);
      if (right != Axis::none) f(right, row);
    }
    if (sx == sy && born != Axis::infinite && diamond()) {
      f(col - born, row), f(x.above(col, born), row);
      f(col, row - born), f(col, y.above(row, born));
    }
  }

 private:
  template <class F>
  static void on_both_sides(const Axis& axis, int i, int s, F f) {
    if (const int below = axis.child_below(i, s); below != Axis::none) f(below);
    if (const int above = axis.child_above(i, s); above != Axis::none) f(above);
  }
};

/// Distance between two cells, in cells.
inline double distance_cells(int col, int row, int to_col, int to_row) {
  return std::hypot(double(to_col - col), double(to_row - row));
}

}  // namespace dem::midpoint
