#include "spline/cuts.h"

#include <algorithm>
#include <cmath>

#include "dem/breaklines.h"
#include "numeric/parallel.h"

namespace dem::spline {
using namespace numeric;
namespace {

constexpr int difference[4][4] = {{1, 0, 0, 0}, {-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};

/// Position of each offset in the diamond; -1: none.
constexpr std::array<std::array<int, 7>, 7> position = [] {
  std::array<std::array<int, 7>, 7> at{};
  for (auto& row : at) row.fill(-1);
  for (int p = 0; p < diamond_points; ++p) {
    const auto [dx, dy] = diamond[std::size_t(p)];
    at[std::size_t(dy + 3)][std::size_t(dx + 3)] = p;
  }
  return at;
}();

/// Adds the springs Dx^i Dy^j that hold cell (x, y) and are whole; true when one is cut.
bool add_springs(double c, int i, int j, const Mask& breaks, int x, int y, CutCell& cell) {
  bool cut = false;
  for (int b = std::max(0, y + j - breaks.rows() + 1); b <= std::min(j, y); ++b)
    for (int a = std::max(0, x + i - breaks.cols() + 1); a <= std::min(i, x); ++a) {
      if (is_broken(breaks, x - a, y - b, i + 1, j + 1)) {
        cut = true;
        continue;
      }
      const double own = c * difference[i][a] * difference[j][b];
      for (int n = 0; n <= j; ++n)
        for (int m = 0; m <= i; ++m)
          cell.entry[std::size_t(position[std::size_t(n - b + 3)][std::size_t(m - a + 3)])] +=
              own * difference[i][m] * difference[j][n];
    }
  return cut;
}

}  // namespace

CutCells::CutCells(const Springs& springs, const Mask& breaks) {
  if (breaks.empty()) return;
  const auto near = cells_near_breaks(breaks, 3);
  std::vector<std::vector<CutCell>> rows(near.size());
  parallel_for(0, breaks.rows(), 16, [&](int y) {
    for (const int x : near[std::size_t(y)]) {
      CutCell cell{x, {}};
      bool cut = false;
      for (int i = 0; i <= 3; ++i)
        for (int j = 0; i + j <= 3; ++j)
          if (springs.c[i][j] != 0) cut |= add_springs(springs.c[i][j], i, j, breaks, x, y, cell);
      if (cut) rows[std::size_t(y)].push_back(cell);
    }
  });
  first_.push_back(0);
  for (const auto& row : rows) {
    cells_.insert(cells_.end(), row.begin(), row.end());
    first_.push_back(cells_.size());
  }
}

std::span<const CutCell> CutCells::row(int y) const {
  if (cells_.empty()) return {};
  return std::span(cells_).subspan(first_[std::size_t(y)],
                                   first_[std::size_t(y) + 1] - first_[std::size_t(y)]);
}

const CutCell* CutCells::find(int x, int y) const {
  const auto cells = row(y);
  const auto at = std::ranges::lower_bound(cells, x, {}, &CutCell::col);
  return at != cells.end() && at->col == x ? &*at : nullptr;
}

double CutCells::largest_eigenvalue() const {
  double largest = 0;
  for (const CutCell& cell : cells_) {
    double sum = 0;
    for (const double e : cell.entry) sum += std::abs(e);
    const double diagonal = cell.entry[diamond_points / 2];
    if (diagonal > 0) largest = std::max(largest, sum / diagonal);
  }
  return largest;
}

std::vector<std::vector<int>> cells_near_breaks(const Mask& breaks, int reach) {
  std::vector<std::vector<int>> near(std::size_t(breaks.rows()));
  Mask marked(breaks.size());
  for (int row = 0; row < breaks.rows(); ++row)
    for (int col = 0; col < breaks.cols(); ++col) {
      const int here = breaks(col, row);
      if (here == 0) continue;
      // The edge's other end lies one column or row further.
      const int right = col + reach + (here & break_east ? 1 : 0);
      const int below = row + reach + (here & break_south ? 1 : 0);
      for (int y = std::max(0, row - reach); y <= std::min(breaks.rows() - 1, below); ++y)
        for (int x = std::max(0, col - reach); x <= std::min(breaks.cols() - 1, right); ++x)
          marked(x, y) = 1;
    }
  for (int row = 0; row < breaks.rows(); ++row)
    for (int col = 0; col < breaks.cols(); ++col)
      if (marked(col, row)) near[std::size_t(row)].push_back(col);
  return near;
}

Mask coarser_breaks(const Mask& fine, Size coarse, bool half_x, bool half_y) {
  if (fine.empty()) return {};
  Mask out(coarse);
  const int step_x = half_x ? 2 : 1, step_y = half_y ? 2 : 1;
  const auto broken = [&](int x, int y, int edge) {
    return fine.contains(x, y) && (fine(x, y) & edge);
  };
  for (int Y = 0; Y < coarse.rows; ++Y)
    for (int X = 0; X < coarse.cols; ++X) {
      int edges = 0;
      for (int k = 0; k < step_x; ++k)
        if (broken(step_x * X + k, step_y * Y, break_east)) edges |= break_east;
      for (int k = 0; k < step_y; ++k)
        if (broken(step_x * X, step_y * Y + k, break_south)) edges |= break_south;
      out(X, Y) = std::uint8_t(edges);
    }
  return out;
}

}  // namespace dem::spline
