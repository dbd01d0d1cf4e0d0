#pragma once
// Breaklines in the spline: springs that reach across one are cut. Private to the library.

#include <array>
#include <span>
#include <vector>

#include "dem/dem.h"
#include "spline/springs.h"

namespace dem::spline {

/// A row of the matrix A at a cell some of whose springs are cut; entries in the order of
/// `diamond`.
struct CutCell {
  int col;
  std::array<double, diamond_points> entry;
};

/// The rows of A that breaklines change: a spring is cut when an edge within its block of cells is
/// broken. Elsewhere A is a Stencil.
///
///      o--o--o        the spring (2, 1) is cut when one of these seven edges is broken
///      |  |  |
///      o--o--o
class CutCells {
 public:
  CutCells() = default;
  CutCells(const Springs& springs, const Mask& breaks);

  bool empty() const { return cells_.empty(); }
  std::span<const CutCell> row(int y) const;

  /// The row of A at a cell; null where no spring is cut.
  const CutCell* find(int x, int y) const;

  /// At least as large as the largest eigenvalue of A divided by its diagonal, as far as these rows
  /// have a say (Gershgorin).
  double largest_eigenvalue() const;

 private:
  std::vector<CutCell> cells_;
  std::vector<std::size_t> first_;  // by row
};

/// Cells at most `reach` columns and rows from a broken edge, by row.
std::vector<std::vector<int>> cells_near_breaks(const Mask& breaks, int reach);

/// Breaks of the grid that keeps every second column (half_x) and row: an edge is broken when one
/// that it stands for is.
Mask coarser_breaks(const Mask& fine, Size coarse, bool half_x, bool half_y);

}  // namespace dem::spline
