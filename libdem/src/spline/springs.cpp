#include "spline/springs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dem::spline {
namespace {

// Forward differences of order 0 to 3.
constexpr int difference[4][4] = {{1, 0, 0, 0}, {-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};

/// Entry (a, b) of D^T D for differences of one order on n nodes.
double gram(int n, int order, int a, int b) {
  double sum = 0;
  const int first = std::max({0, a - order, b - order});
  const int last = std::min({n - 1 - order, a, b});
  for (int m = first; m <= last; ++m) sum += difference[order][a - m] * difference[order][b - m];
  return sum;
}

/// Seven classes of rows: three at either end and the interior; a short axis has one for each row.
int classes(int n) { return std::min(n, 7); }
int class_of(int n, int i) { return n <= 7 || i < 3 ? i : i >= n - 3 ? i - n + 7 : 3; }
int row_of_class(int n, int k) { return n <= 7 || k <= 3 ? k : k + n - 7; }

}  // namespace

Springs terrain_springs(double a1, double a2, double a3, double X, bool fourth_order) {
  const double e1 = fourth_order ? a1 / 12 : 0, e2 = fourth_order ? a2 / 6 : 0;
  Springs s;
  auto& c = s.c;
  c[1][0] = a1 * X;
  c[0][1] = a1;
  c[2][0] = a2 * X * X + e1 * X;
  c[1][1] = 2 * a2 * X;
  c[0][2] = a2 + e1;
  c[3][0] = a3 * X * X * X + e2 * X * X;
  c[2][1] = 3 * a3 * X * X + e2 * X;
  c[1][2] = 3 * a3 * X + e2 * X;
  c[0][3] = a3 + e2;
  return s;
}

Springs coarsen(const Springs& springs, double hx, double hy) {
  Springs coarse;
  for (int i = 0; i <= 3; ++i)
    for (int j = 0; i + j <= 3; ++j)
      coarse.c[i][j] = springs.c[i][j] * std::pow(hx, 1 - 2 * i) * std::pow(hy, 1 - 2 * j);
  return coarse;
}

Stencil::Stencil(const Springs& springs, Size size) : springs_(springs), size_(size) {
  for (int k = 0; k < classes(size.rows); ++k) {
    const int y = row_of_class(size.rows, k);
    RowStencil<double> row{};
    for (int p = 0; p < diamond_points; ++p) {
      const auto [dx, dy] = diamond[p];
      for (int lane = 0; lane < 4; ++lane) {
        row.left[p][lane] = at(lane, y, dx, dy);
        row.right[p][lane] = at(right_begin(size.cols) + lane, y, dx, dy);
      }
      if (dx >= 0 && size.cols >= 7) row.mid[dy + 3][dx] = at(3, y, dx, dy);
    }
    RowStencil<float> rounded{};
    const auto round = [](double v) { return float(v); };
    std::transform(&row.mid[0][0], &row.mid[0][0] + 28, &rounded.mid[0][0], round);
    std::transform(&row.left[0][0], &row.left[0][0] + 100, &rounded.left[0][0], round);
    std::transform(&row.right[0][0], &row.right[0][0] + 100, &rounded.right[0][0], round);
    rows_.push_back(rounded);
    exact_rows_.push_back(row);
  }
}

std::size_t Stencil::row_class(int y) const { return std::size_t(class_of(size_.rows, y)); }

double Stencil::at(int x, int y, int dx, int dy) const {
  const auto inside = [](int i, int n) { return i >= 0 && i < n; };
  if (!inside(x, size_.cols) || !inside(x + dx, size_.cols) || !inside(y, size_.rows) ||
      !inside(y + dy, size_.rows))
    return 0;
  double sum = 0;
  for (int i = std::abs(dx); i <= 3; ++i)
    for (int j = std::abs(dy); i + j <= 3; ++j)
      if (springs_.c[i][j] != 0)
        sum += springs_.c[i][j] * gram(size_.cols, i, x, x + dx) * gram(size_.rows, j, y, y + dy);
  return sum;
}

double Stencil::interior_diagonal() const {
  return diagonal(std::min(3, size_.cols / 2), std::min(3, size_.rows / 2));
}

double Stencil::largest_eigenvalue() const {
  // Springs that a narrow grid has no room for do not count.
  const int max_i = std::min(3, size_.cols - 1), max_j = std::min(3, size_.rows - 1);
  constexpr double binomial[4] = {1, 2, 6, 20};  // diagonal of D^T D
  double diagonal = 0;
  for (int i = 0; i <= max_i; ++i)
    for (int j = 0; j <= max_j; ++j)
      if (i + j <= 3) diagonal += springs_.c[i][j] * binomial[i] * binomial[j];
  // The symbol grows with either frequency: its largest value is at Nyquist.
  double largest = 0;
  for (int i = 0; i <= max_i; ++i)
    for (int j = 0; j <= max_j; ++j)
      if (i + j <= 3) largest += springs_.c[i][j] * std::pow(4., i + j);
  return diagonal > 0 ? largest / diagonal : 1;
}

}  // namespace dem::spline
