#include "spline/multigrid.h"

#include <cmath>
#include <limits>

#include "numeric/parallel.h"

namespace dem::spline {
using namespace numeric;
namespace {

constexpr int degree = 6;             // of the Chebyshev smoother, before and after the coarse grid
constexpr double smoothed_part = 40;  // it damps the eigenvalues above largest / smoothed_part
constexpr int coarsest_cells = 100;
constexpr double pin_cap = 1000;
constexpr double leak = 0.01;  // of the diagonal, beside breaklines of coarse grids

// ---- Stencil kernels

template <class T>
DEM_INLINE inline T diamond_sum(const T* const (&u)[7], const T (&c)[7][4], int x) {
  return (c[0][0] * u[0][x] + c[6][0] * u[6][x]) +
         (c[1][0] * u[1][x] + c[1][1] * (u[1][x - 1] + u[1][x + 1])) +
         (c[5][0] * u[5][x] + c[5][1] * (u[5][x - 1] + u[5][x + 1])) +
         (c[2][0] * u[2][x] + c[2][1] * (u[2][x - 1] + u[2][x + 1]) +
          c[2][2] * (u[2][x - 2] + u[2][x + 2])) +
         (c[4][0] * u[4][x] + c[4][1] * (u[4][x - 1] + u[4][x + 1]) +
          c[4][2] * (u[4][x - 2] + u[4][x + 2])) +
         (c[3][0] * u[3][x] + c[3][1] * (u[3][x - 1] + u[3][x + 1]) +
          c[3][2] * (u[3][x - 2] + u[3][x + 2]) + c[3][3] * (u[3][x - 3] + u[3][x + 3]));
}

/// Four columns at an end of the row, each with its own stencil.
template <class T, class Each>
DEM_INLINE inline void lanes(const T (&c)[diamond_points][4], const T* const (&u)[7], int base,
                             int cols, const Each& each) {
  T sum[4] = {};
  for (int p = 0; p < diamond_points; ++p) {
    const T* from = u[diamond[std::size_t(p)].dy + 3] + base + diamond[std::size_t(p)].dx;
    for (int l = 0; l < 4; ++l) sum[l] += c[p][l] * from[l];
  }
  for (int l = 0; l < 4; ++l)
    if (base + l < cols) each(base + l, sum[l]);
}

/// Calls each(x, (A u)(x)) for the columns of a span.
template <class T, class Each>
DEM_INLINE inline void for_span(const RowStencil<T>& A, const T* const* rows, Span span, int cols,
                                const Each& each) {
  const T* const u[7] = {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6]};
  const int right = right_begin(cols);
  if (span.begin < 4) lanes(A.left, u, 0, cols, each);
  T c[7][4];
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 4; ++j) c[i][j] = A.mid[i][j];
  const int begin = std::max(span.begin, 4), end = std::min(span.end, right);
  DEM_INDEPENDENT
  for (int x = begin; x < end; ++x) each(x, diamond_sum(u, c, x));
  if (span.end > right) lanes(A.right, u, right, cols, each);
}

/// One step of the Chebyshev recurrence on a span:
///   next = now + a (now - before) + c dinv (b - A now - w now).
template <bool weighted>
DEM_INLINE inline void chebyshev_step(const RowStencil<float>& A, const float* const* now,
                                      const float* __restrict before, const float* __restrict b,
                                      const float* __restrict dinv, const float* __restrict w,
                                      float a, float c, Span span, int cols,
                                      float* __restrict next) {
  const float* __restrict here = now[3];
  for_span(A, now, span, cols, [=](int x, float Au) DEM_INLINE {
    const float r = weighted ? b[x] - Au - w[x] * here[x] : b[x] - Au;
    next[x] = here[x] + a * (here[x] - before[x]) + c * dinv[x] * r;
  });
}

DEM_VECTORISED void chebyshev_row(const RowStencil<float>& A, const float* const* now,
                                  const float* before, const float* b, const float* dinv, float a,
                                  float c, Span span, int cols, float* next) {
  chebyshev_step<false>(A, now, before, b, dinv, nullptr, a, c, span, cols, next);
}

DEM_VECTORISED void weighted_chebyshev_row(const RowStencil<float>& A, const float* const* now,
                                           const float* before, const float* b, const float* dinv,
                                           const float* w, float a, float c, Span span, int cols,
                                           float* next) {
  chebyshev_step<true>(A, now, before, b, dinv, w, a, c, span, cols, next);
}

/// out = 0 where dinv is 0. A pass of its own: a choice inside the stencil's loop would be a
/// branch.
DEM_INLINE inline void keep_free(const float* dinv, Span span, float* out) {
  DEM_INDEPENDENT
  for (int x = span.begin; x < span.end; ++x) out[x] = dinv[x] != 0 ? out[x] : 0;
}

DEM_VECTORISED void free_residual_row(const RowStencil<float>& A, const float* const* u,
                                      const float* b, const float* dinv, const float* w, Span span,
                                      int cols, float* out) {
  const float* here = u[3];
  if (w)
    for_span(A, u, span, cols,
             [=](int x, float Au) DEM_INLINE { out[x] = b[x] - Au - w[x] * here[x]; });
  else
    for_span(A, u, span, cols, [=](int x, float Au) DEM_INLINE { out[x] = b[x] - Au; });
  keep_free(dinv, span, out);
}

DEM_VECTORISED void first_step_row(const float* dinv, const float* b, float c, Span span,
                                   float* out) {
  DEM_INDEPENDENT
  for (int x = span.begin; x < span.end; ++x) out[x] = c * dinv[x] * b[x];
}

// ---- Between grids

/// sum = here + (sum + below) / 2.
DEM_VECTORISED void between_row(const float* here, const float* below, int cols, float* sum) {
  DEM_INDEPENDENT
  for (int x = 0; x < cols; ++x) sum[x] = here[x] + 0.5f * (sum[x] + below[x]);
}

/// Half of the transposed linear interpolation: out[X] = in[2X] + (in[2X - 1] + in[2X + 1]) / 2.
DEM_VECTORISED void halve_row(const float* in, int coarse_cols, float* out) {
  DEM_INDEPENDENT
  for (int X = 0; X < coarse_cols; ++X) out[X] = in[2 * X] + 0.5f * (in[2 * X - 1] + in[2 * X + 1]);
}

/// Linear interpolation of a coarse row, added to a fine one's free cells; columns [begin, end),
/// even.
DEM_VECTORISED void double_row(const float* coarse, const float* u, const float* dinv, int begin,
                               int end, float* out) {
  DEM_INDEPENDENT
  for (int X = begin / 2; X < (end + 1) / 2; ++X) {
    const float even = coarse[X], odd = 0.5f * (coarse[X] + coarse[X + 1]);
    const float at_even = u[2 * X] + even, at_odd = u[2 * X + 1] + odd;
    out[2 * X] = dinv[2 * X] != 0 ? at_even : 0;
    out[2 * X + 1] = dinv[2 * X + 1] != 0 ? at_odd : 0;
  }
}

DEM_VECTORISED void mean_row(const float* one, const float* other, int cols, float* out) {
  DEM_INDEPENDENT
  for (int x = 0; x < cols; ++x) out[x] = 0.5f * (one[x] + other[x]);
}

DEM_VECTORISED void copy_row(const float* coarse, const float* u, const float* dinv, int begin,
                             int end, float* out) {
  DEM_INDEPENDENT
  for (int x = begin; x < end; ++x) {
    const float sum = u[x] + coarse[x];
    out[x] = dinv[x] != 0 ? sum : 0;
  }
}

struct Halving {
  bool x, y;
};
Halving halving(const Level& fine, const Level& coarse) {
  return {coarse.hx > fine.hx, coarse.hy > fine.hy};
}

// ---- Between grids with breaklines: an odd cell takes from those even neighbours that no line
// parts it from; where that is one side only, along the straight line through its two even cells.
//
//     X - 1     X   |   X + 1
//        o - - o - x|- o          x = 3/2 X - 1/2 (X - 1)

/// Whether neighbouring cells along a row (a column) hang together; those off the grid do.
bool open(const Mask& breaks, int x, int y, std::uint8_t edge) {
  return !breaks.contains(x, y) || !(breaks(x, y) & edge);
}

/// What an odd cell takes from the even cells 3 and 1 before it, and 1 and 3 after it.
struct Shares {
  float part[4];
};
constexpr Shares even_cell{{0, 1, 0, 0}};

/// `is_open(k)`: whether cells k and k + 1 hang together, counted from the odd cell.
template <class Open>
Shares shares(const Open& is_open) {
  const bool before = is_open(-1), after = is_open(0);
  if (before && after) return {{0, 0.5f, 0.5f, 0}};
  if (before)
    return is_open(-3) && is_open(-2) ? Shares{{-0.5f, 1.5f, 0, 0}} : Shares{{0, 1, 0, 0}};
  if (after) return is_open(1) && is_open(2) ? Shares{{0, 0, 1.5f, -0.5f}} : Shares{{0, 0, 1, 0}};
  return {{0, 0, 0, 0}};
}

Shares shares_along_row(const Level& fine, int x, int y) {
  return shares([&](int k) {
    const bool inside = x + k >= 0 && x + k + 1 <= fine.size.cols;
    return (inside || k == -1 || k == 0) && open(fine.breaks, x + k, y, break_east);
  });
}
Shares shares_along_column(const Level& fine, int x, int y) {
  return shares([&](int k) {
    const bool inside = y + k >= 0 && y + k + 1 <= fine.size.rows;
    return (inside || k == -1 || k == 0) && open(fine.breaks, x, y + k, break_south);
  });
}

/// The interpolation of coarse rows to the fine row y.
void interpolate_broken(const Level& fine, Halving half, int y, const Grid<float>& coarse,
                        std::vector<float>& out) {
  const int coarse_cols = coarse.size().cols, coarse_rows = coarse.size().rows;
  const int step = half.x ? 2 : 1;
  out.assign(std::size_t(2 * coarse_cols), 0.f);
  const bool odd = half.y && y % 2 == 1;
  const float* rows[4];
  for (int k = 0; k < 4; ++k)
    rows[k] = coarse.row(std::clamp((half.y ? y / 2 : y) - 1 + k, 0, coarse_rows - 1));
  for (int X = 0; X < coarse_cols; ++X) {
    const Shares s = odd ? shares_along_column(fine, step * X, y) : even_cell;
    float sum = 0;
    for (int k = 0; k < 4; ++k) sum += s.part[k] * rows[k][X];
    out[std::size_t(step * X)] = sum;
  }
  if (!half.x) return;
  for (int x = 1; x < fine.size.cols; x += 2) {
    const Shares s = shares_along_row(fine, x, y);
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
      const int at = x - 3 + 2 * k;
      if (s.part[k] != 0) sum += s.part[k] * out[std::size_t(at)];
    }
    out[std::size_t(x)] = sum;
  }
}

/// Coarse rows [Y0, Y1) of the transposed interpolation of the fine rows that fine_row(y, row)
/// makes.
template <class FineRow>
void restrict_broken(const Level& level, Halving half, int Y0, int Y1, Grid<float>& coarse,
                     const FineRow& fine_row) {
  const Size fine = level.size;
  const int coarse_cols = coarse.size().cols, step = half.x ? 2 : 1;
  std::vector<float> buffer(std::size_t(Grid<float>::stride_for(2 * coarse_cols)));
  float* row = buffer.data() + Grid<float>::margin;
  for (int Y = Y0; Y < Y1; ++Y) std::fill_n(coarse.row(Y), coarse_cols, 0.f);
  const int y0 = half.y ? 2 * Y0 - 3 : Y0, y1 = half.y ? 2 * Y1 + 2 : Y1;
  for (int y = std::max(0, y0); y < std::min(fine.rows, y1); ++y) {
    fine_row(y, row);
    std::fill(row + fine.cols, row + 2 * coarse_cols, 0.f);
    if (half.x)
      for (int x = 1; x < fine.cols; x += 2) {
        const Shares s = shares_along_row(level, x, y);
        for (int k = 0; k < 4; ++k)
          if (s.part[k] != 0) row[x - 3 + 2 * k] += s.part[k] * row[x];
      }
    const bool odd = half.y && y % 2 == 1;
    for (int X = 0; X < coarse_cols; ++X) {
      const Shares s = odd ? shares_along_column(level, step * X, y) : even_cell;
      for (int k = 0; k < 4; ++k) {
        const int Y = (half.y ? y / 2 : y) - 1 + k;
        if (s.part[k] != 0 && Y >= Y0 && Y < Y1) coarse.row(Y)[X] += s.part[k] * row[step * X];
      }
    }
  }
}

/// Coarse rows [Y0, Y1) of P^T times the fine rows that `fine_row(y, row)` makes.
template <class FineRow>
void restrict_band(const Level& level, Halving half, int Y0, int Y1, Grid<float>& coarse,
                   const FineRow& fine_row) {
  if (!level.breaks.empty()) return restrict_broken(level, half, Y0, Y1, coarse, fine_row);
  const Size fine = level.size;
  const std::size_t stride = std::size_t(Grid<float>::stride_for(fine.cols));
  std::vector<float> buffers(3 * stride);
  float* here = buffers.data() + Grid<float>::margin;
  float* below = here + stride;  // between this coarse row and the next: used for both
  float* sum = below + stride;
  const auto make = [&](int y, float* row) {
    if (y >= 0 && y < fine.rows)
      fine_row(y, row);
    else
      std::fill(row, row + fine.cols, 0.f);
  };
  if (half.y) make(2 * Y0 - 1, below);
  for (int Y = Y0; Y < Y1; ++Y) {
    const float* combined = here;
    if (half.y) {
      std::copy(below, below + fine.cols, sum);
      make(2 * Y, here);
      make(2 * Y + 1, below);
      between_row(here, below, fine.cols, sum);
      combined = sum;
    } else {
      make(Y, here);
    }
    if (half.x)
      halve_row(combined, coarse.size().cols, coarse.row(Y));
    else
      std::copy(combined, combined + fine.cols, coarse.row(Y));
  }
}

// ---- Bands of rows

/// Calls work(y0, y1) for bands that cover all rows. What is computed for a row must not depend on
/// the band it is in; then neither does the result depend on the number of threads.
template <class Work>
void in_bands(int rows, int cols, const Work& work) {
  constexpr int smallest_band_cells = 16384;
  const int threads = tbb::this_task_arena::max_concurrency();
  const int most = std::max(1, int(std::int64_t(rows) * cols / smallest_band_cells));
  const int bands = std::min({threads, most, std::max(1, rows / 48)});
  parallel_for(0, bands, 1, [&](int i) {
    work(int(std::int64_t(rows) * i / bands), int(std::int64_t(rows) * (i + 1) / bands));
  });
}

/// A few rows around the front of each smoothing step; rows are found modulo 8.
class Ring {
 public:
  explicit Ring(int cols)
      : stride_(std::size_t(Grid<float>::stride_for(cols))), cells_(8 * stride_) {}
  float* row(int y) { return cells_.data() + std::size_t(y & 7) * stride_ + Grid<float>::margin; }

 private:
  std::size_t stride_;
  std::vector<float> cells_;
};

std::vector<Step> chebyshev_steps(double largest) {
  const double smallest = largest / smoothed_part;
  const double theta = (largest + smallest) / 2, delta = (largest - smallest) / 2;
  const double sigma = theta / delta;
  std::vector<Step> steps{{0.f, float(1 / theta)}};
  double rho = 1 / sigma;
  while (int(steps.size()) < degree) {
    const double next = 1 / (2 * sigma - rho);
    steps.push_back({float(next * rho), float(2 * next / delta)});
    rho = next;
  }
  return steps;
}

/// Smooths rows [y0, y1) into `out`. All steps run down the rows together, each three rows behind
/// the one before, so that rows are still in the cache:
///
///   step 0   . . . . . . . . . #          `start(y, row)` makes the iterate before step `first`
///   step 1   . . . . . . #
///   step 2   . . . #                      # the row each step makes at one moment
template <class Start>
void smooth_band(const Level& level, const std::vector<Step>& steps, int first,
                 const Grid<float>& b, int y0, int y1, Grid<float>& out, const Start& start) {
  const int cols = level.size.cols, rows = level.size.rows;
  const int stages = int(steps.size()) - first;
  std::vector<Ring> rings(static_cast<std::size_t>(stages), Ring(cols));
  const std::vector<float> zeros(static_cast<std::size_t>(Grid<float>::stride_for(cols)));
  const float* zero = zeros.data() + Grid<float>::margin;

  const auto make_row = [&](int k, int y) {
    const int halo = 3 * (stages - k);
    if (y < std::max(0, y0 - halo) || y >= std::min(rows, y1 + halo)) return;
    float* next = k == stages ? out.row(y) : rings[std::size_t(k)].row(y);
    const auto spans = level.spans.row(y);
    clear_gaps(next, spans, cols);
    if (k == 0) return start(y, next);
    std::array<const float*, 7> now;
    for (int dy = -3; dy <= 3; ++dy)
      now[std::size_t(dy + 3)] =
          y + dy < 0 || y + dy >= rows ? zero : rings[std::size_t(k - 1)].row(y + dy);
    const float* before = k >= 2 ? rings[std::size_t(k - 2)].row(y) : zero;
    const Step step = steps[std::size_t(first + k - 1)];
    for (const Span span : spans) {
      if (level.w.empty())
        chebyshev_row(level.A.row(y), now.data(), before, b.row(y), level.dinv.row(y), step.a,
                      step.c, span, cols, next);
      else
        weighted_chebyshev_row(level.A.row(y), now.data(), before, b.row(y), level.dinv.row(y),
                               level.w.row(y), step.a, step.c, span, cols, next);
    }
    const float* w = level.w.empty() ? zero : level.w.row(y);
    for_cut_cells(level, y, now.data(), [&](int x, float Au) {
      const float here = now[3][x], r = b.row(y)[x] - Au - w[x] * here;
      next[x] = here + step.a * (here - before[x]) + step.c * level.dinv.row(y)[x] * r;
    });
  };
  for (int y = y0 - 3 * stages; y < y1 + 3 * stages; ++y)
    for (int k = 0; k <= stages; ++k) make_row(k, y - 3 * k);
}

/// The parents of a row's spans: coarse cells whose interpolation reaches into them.
void add_coarse_row(const Level& fine, Halving half, int Y, int coarse_cols, Spans& out) {
  std::vector<Span> parts;
  const int from = half.y ? 2 * Y - 1 : Y, to = half.y ? 2 * Y + 1 : Y;
  for (int y = std::max(from, 0); y <= std::min(to, fine.size.rows - 1); ++y)
    for (const Span s : fine.spans.row(y))
      parts.push_back(half.x ? Span{s.begin / 2, std::min(s.end / 2 + 1, coarse_cols)} : s);
  std::sort(parts.begin(), parts.end(), [](Span a, Span b) { return a.begin < b.begin; });
  out.add_row(parts, coarse_cols);
}

}  // namespace

DEM_VECTORISED void apply_row(const RowStencil<float>& A, const float* const* u, const float* w,
                              const float* dinv, Span span, int cols, float* out) {
  const float* here = u[3];
  if (w)
    for_span(A, u, span, cols, [=](int x, float Au) DEM_INLINE { out[x] = Au + w[x] * here[x]; });
  else
    for_span(A, u, span, cols, [=](int x, float Au) DEM_INLINE { out[x] = Au; });
  keep_free(dinv, span, out);
}

DEM_VECTORISED void residual_row(const RowStencil<double>& A, const double* const* x,
                                 const float* f, const float* w, const float* dinv, Span span,
                                 int cols, float* out) {
  const double* here = x[3];
  if (w)
    for_span(A, x, span, cols, [=](int i, double Ax) DEM_INLINE {
      out[i] = float(double(f[i]) - Ax - double(w[i]) * here[i]);
    });
  else if (f)
    for_span(A, x, span, cols,
             [=](int i, double Ax) DEM_INLINE { out[i] = float(double(f[i]) - Ax); });
  else
    for_span(A, x, span, cols, [=](int i, double Ax) DEM_INLINE { out[i] = float(-Ax); });
  keep_free(dinv, span, out);
}

double Level::entry(int x, int y, int p) const {
  if (const CutCell* cut = cuts.find(x, y)) return cut->entry[std::size_t(p)];
  const auto [dx, dy] = diamond[std::size_t(p)];
  return A.at(x, y, dx, dy);
}

// ---- The coarsest grid

BandedFactor::BandedFactor(const Level& level)
    : size_(level.size), band_(3 * level.size.cols), fixed_(level.size.cells()) {
  const int n = int(size_.cells()), cols = size_.cols;
  l_.assign(std::size_t(n) * std::size_t(band_ + 1), 0);
  for (int i = 0; i < n; ++i) fixed_[std::size_t(i)] = level.dinv.row(i / cols)[i % cols] == 0;
  for (int i = 0; i < n; ++i) {
    const int x = i % cols, y = i / cols;
    if (fixed_[std::size_t(i)]) {
      at(i, i) = 1;
      continue;
    }
    for (int p = 0; p < diamond_points; ++p) {
      const auto [dx, dy] = diamond[std::size_t(p)];
      const int j = i + dy * cols + dx;
      if (x + dx < 0 || x + dx >= cols || j < 0 || j > i || fixed_[std::size_t(j)]) continue;
      at(i, j) = level.entry(x, y, p);
    }
    if (!level.w.empty()) at(i, i) += double(level.w.row(y)[x]);
  }
  for (int i = 0; i < n; ++i)
    for (int j = std::max(0, i - band_); j <= i; ++j) {
      double sum = at(i, j);
      for (int k = std::max(0, i - band_); k < j; ++k) sum -= at(i, k) * at(j, k);
      at(i, j) =
          i == j ? std::sqrt(std::max(sum, std::numeric_limits<double>::min())) : sum / at(j, j);
    }
}

void BandedFactor::solve(const Grid<float>& b, Grid<float>& x) const {
  const int n = int(size_.cells()), cols = size_.cols;
  std::vector<double> v(std::size_t(n), 0.);
  for (int i = 0; i < n; ++i) {
    double sum = fixed_[std::size_t(i)] ? 0 : double(b.row(i / cols)[i % cols]);
    for (int k = std::max(0, i - band_); k < i; ++k) sum -= at(i, k) * v[std::size_t(k)];
    v[std::size_t(i)] = sum / at(i, i);
  }
  for (int i = n - 1; i >= 0; --i) {
    double sum = v[std::size_t(i)];
    for (int k = i + 1; k <= std::min(n - 1, i + band_); ++k) sum -= at(k, i) * v[std::size_t(k)];
    v[std::size_t(i)] = sum / at(i, i);
  }
  for (int i = 0; i < n; ++i) x.row(i / cols)[i % cols] = float(v[std::size_t(i)]);
}

// ---- The hierarchy

namespace {

/// The part of a spring's own cell in A, for every column of a row.
void diagonal_row(const Level& level, int y, std::vector<float>& out) {
  constexpr int centre = diamond_points / 2;
  const RowStencil<float>& A = level.A.row(y);
  const int cols = level.size.cols;
  out.assign(std::size_t(cols), A.mid[3][0]);
  const int right = right_begin(cols);
  for (int l = 0; l < 4 && l < cols; ++l) out[std::size_t(l)] = A.left[centre][l];
  for (int l = 0; l < 4 && right + l < cols; ++l) out[std::size_t(right + l)] = A.right[centre][l];
  for (const CutCell& cut : level.cuts.row(y))
    out[std::size_t(cut.col)] = float(cut.entry[std::size_t(centre)]);
}

/// Halves the axes that have room for it. On long cells, the axis with the shorter side first.
Halving next_halving(const Level& fine, double X) {
  const double width = fine.hx, height = fine.hy * std::sqrt(X);  // in columns
  Halving half{height * 2 > width, width * 2 > height};
  if (height >= 2 * width) half = {true, false};
  if (width >= 2 * height) half = {false, true};
  const bool room_x = fine.size.cols > 8, room_y = fine.size.rows > 8;
  if ((half.x && room_x) || (half.y && room_y)) return {half.x && room_x, half.y && room_y};
  return {room_x, room_y};
}

/// How much data pins a cell of one grid: number of data cells, and the sum of their weights.
struct Pins {
  Grid<float> count, weight;
};

/// Pins of the finest grid's row: a fixed cell counts as one with a boundless weight.
void fine_count_row(const Level& fine, int y, float* row) {
  const float* dinv = fine.dinv.row(y);
  const float* w = fine.w.empty() ? nullptr : fine.w.row(y);
  for (int x = 0; x < fine.size.cols; ++x) row[x] = dinv[x] == 0 || (w && w[x] > 0) ? 1.f : 0.f;
}

void fine_weight_row(const Level& fine, int y, float* row) {
  constexpr float boundless = 1e30f;
  const float* dinv = fine.dinv.row(y);
  const float* w = fine.w.row(y);
  for (int x = 0; x < fine.size.cols; ++x) row[x] = dinv[x] == 0 ? boundless : w[x];
}

template <class FineRow>
Grid<float> restricted(const Level& fine, Size coarse, Halving half, const FineRow& fine_row) {
  Grid<float> out(coarse);
  in_bands(coarse.rows, coarse.cols,
           [&](int Y0, int Y1) { restrict_band(fine, half, Y0, Y1, out, fine_row); });
  return out;
}

Level make_finest(const Springs& springs, const Mask& free, Grid<float> w, const Mask& breaks) {
  Level fine;
  fine.size = free.size();
  fine.A = Stencil(springs, fine.size);
  fine.breaks = breaks;
  fine.cuts = CutCells(springs, breaks);
  fine.w = std::move(w);
  fine.dinv = Grid<float>(fine.size);
  fine.u = Grid<float>(fine.size);
  fine.s = Grid<float>(fine.size);
  std::vector<float> diagonal;
  std::vector<Span> parts;
  for (int y = 0; y < fine.size.rows; ++y) {
    diagonal_row(fine, y, diagonal);
    const auto is_free = free.row(y);
    float* dinv = fine.dinv.row(y);
    parts.clear();
    for (int x = 0; x < fine.size.cols; ++x) {
      if (!is_free[std::size_t(x)]) continue;
      const float d = diagonal[std::size_t(x)] + (fine.w.empty() ? 0.f : fine.w.row(y)[x]);
      dinv[x] = d > 0 ? 1 / d : 0;
      if (!parts.empty() && x - parts.back().end < 8)
        parts.back().end = x + 1;
      else
        parts.push_back({x, x + 1});
    }
    fine.spans.add_row(parts, fine.size.cols);
  }
  return fine;
}

Level make_coarse(const Level& fine, Halving half, const Springs& springs) {
  Level coarse;
  coarse.size = {half.x ? fine.size.cols / 2 + 1 : fine.size.cols,
                 half.y ? fine.size.rows / 2 + 1 : fine.size.rows};
  coarse.hx = half.x ? 2 * fine.hx : fine.hx;
  coarse.hy = half.y ? 2 * fine.hy : fine.hy;
  const Springs coarse_springs = coarsen(springs, coarse.hx, coarse.hy);
  coarse.A = Stencil(coarse_springs, coarse.size);
  coarse.breaks = coarser_breaks(fine.breaks, coarse.size, half.x, half.y);
  coarse.cuts = CutCells(coarse_springs, coarse.breaks);
  for (Grid<float>* grid : {&coarse.w, &coarse.dinv, &coarse.b, &coarse.u, &coarse.s})
    *grid = Grid<float>(coarse.size);
  for (int Y = 0; Y < coarse.size.rows; ++Y)
    add_coarse_row(fine, half, Y, coarse.size.cols, coarse.spans);
  return coarse;
}

/// Data cells hold a coarse cell by a spring to 0, as strong as A's own diagonal for each.
void pin(Level& level, const Pins& pins) {
  std::vector<float> diagonal;
  for (int y = 0; y < level.size.rows; ++y) {
    diagonal_row(level, y, diagonal);
    for (const Span span : level.spans.row(y))
      for (int x = span.begin; x < span.end; ++x) {
        const float d = diagonal[std::size_t(x)];
        float w = std::clamp(pins.count.row(y)[x], 0.f, float(pin_cap)) * d;
        if (!pins.weight.empty()) w = std::clamp(pins.weight.row(y)[x], 0.f, w);
        level.w.row(y)[x] = w;
        level.dinv.row(y)[x] = d + w > 0 ? 1 / (d + w) : 0;
      }
    // A part that breaklines close off on this grid alone may hold no data.
    for (const CutCell& cut : level.cuts.row(y)) {
      const float d = diagonal[std::size_t(cut.col)];
      float& w = level.w.row(y)[cut.col];
      w += float(leak) * d;
      if (level.dinv.row(y)[cut.col] != 0) level.dinv.row(y)[cut.col] = 1 / (d + w);
    }
  }
}

}  // namespace

Multigrid::Multigrid(const Springs& springs, double X, const Mask& free, Grid<float> w,
                     const Mask& breaks) {
  levels_.push_back(make_finest(springs, free, std::move(w), breaks));
  const bool weighted = !levels_.front().w.empty();
  Pins pins;
  while (levels_.back().size.cells() > coarsest_cells) {
    const Level& fine = levels_.back();
    const Halving half = next_halving(fine, X);
    if (!half.x && !half.y) break;
    Level coarse = make_coarse(fine, half, springs);
    const bool finest = levels_.size() == 1;
    const auto pins_row = [&](const Grid<float>& pins_grid, auto of_finest) {
      return restricted(fine, coarse.size, half, [&](int y, float* row) {
        if (finest)
          of_finest(fine, y, row);
        else
          std::copy_n(pins_grid.row(y), fine.size.cols, row);
      });
    };
    Pins next{pins_row(pins.count, fine_count_row), {}};
    if (weighted) next.weight = pins_row(pins.weight, fine_weight_row);
    pins = std::move(next);
    pin(coarse, pins);
    levels_.push_back(std::move(coarse));
  }
  for (const Level& level : levels_)
    steps_.push_back(chebyshev_steps(
        std::max(1.05 * level.A.largest_eigenvalue(), level.cuts.largest_eigenvalue())));
  coarsest_ = BandedFactor(levels_.back());
}

const Grid<float>& Multigrid::v_cycle(const Grid<float>& b) {
  cycle(0, b);
  return levels_.front().s;
}

void Multigrid::cycle(std::size_t l, const Grid<float>& b) {
  Level& fine = levels_[l];
  if (l + 1 == levels_.size()) return coarsest_.solve(b, fine.s);
  Level& coarse = levels_[l + 1];
  const Halving half = halving(fine, coarse);
  const auto& steps = steps_[l];
  const int cols = fine.size.cols, rows = fine.size.rows;

  // Smooth from zero.
  in_bands(rows, cols, [&](int y0, int y1) {
    smooth_band(fine, steps, 1, b, y0, y1, fine.u, [&](int y, float* row) {
      for (const Span span : fine.spans.row(y))
        first_step_row(fine.dinv.row(y), b.row(y), steps[0].c, span, row);
    });
  });

  // Carry the residual to the coarse grid.
  in_bands(coarse.size.rows, coarse.size.cols, [&](int Y0, int Y1) {
    const std::vector<float> zeros(static_cast<std::size_t>(Grid<float>::stride_for(cols)));
    const float* zero = zeros.data() + Grid<float>::margin;
    restrict_band(fine, half, Y0, Y1, coarse.b, [&](int y, float* row) {
      clear_gaps(row, fine.spans.row(y), cols);
      const auto around = rows_around(fine.u, y, zero);
      for (const Span span : fine.spans.row(y))
        free_residual_row(fine.A.row(y), around.data(), b.row(y), fine.dinv.row(y),
                          fine.w.empty() ? nullptr : fine.w.row(y), span, cols, row);
      const float* w = fine.w.empty() ? zero : fine.w.row(y);
      for_cut_cells(fine, y, around.data(),
                    [&](int x, float Au) { row[x] = b.row(y)[x] - Au - w[x] * fine.u.row(y)[x]; });
    });
  });

  cycle(l + 1, coarse.b);

  // Add the coarse grid's correction, smooth again.
  in_bands(rows, cols, [&](int y0, int y1) {
    std::vector<float> between(std::size_t(Grid<float>::stride_for(coarse.size.cols)));
    smooth_band(fine, steps, 0, b, y0, y1, fine.s, [&](int y, float* row) {
      if (!fine.breaks.empty()) {
        interpolate_broken(fine, half, y, coarse.s, between);
        for (const Span span : fine.spans.row(y))
          copy_row(between.data(), fine.u.row(y), fine.dinv.row(y), span.begin, span.end, row);
        return;
      }
      const float* correction = coarse.s.row(half.y ? y / 2 : y);
      if (half.y && y % 2 == 1) {
        mean_row(correction, coarse.s.row(y / 2 + 1), coarse.size.cols, between.data());
        correction = between.data();
      }
      for (const Span span : fine.spans.row(y))
        (half.x ? double_row : copy_row)(correction, fine.u.row(y), fine.dinv.row(y), span.begin,
                                         span.end, row);
    });
  });
}

}  // namespace dem::spline
