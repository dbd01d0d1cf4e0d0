#include "spline/spline_solver.h"

#include <algorithm>
#include <cmath>

#include "numeric/parallel.h"

namespace dem::spline {
using namespace numeric;
namespace {

constexpr int row_grain = 16;

// Bounds of the rate at which steps are taken to shrink, when what is left is estimated.
constexpr double fastest_rate = 0.6, slowest_rate = 0.95;

/// Sums in eight lanes, so that the order of additions is fixed and the loop is still a vector one.
struct Lanes {
  double lane[8] = {};
  double sum() const {
    return ((lane[0] + lane[1]) + (lane[2] + lane[3])) +
           ((lane[4] + lane[5]) + (lane[6] + lane[7]));
  }
};

DEM_VECTORISED double dot_span(const float* a, const float* b, Span span) {
  Lanes ab;
  int x = span.begin;
  for (; x + 8 <= span.end; x += 8)
    for (int l = 0; l < 8; ++l) ab.lane[l] += double(a[x + l]) * double(b[x + l]);
  for (; x < span.end; ++x) ab.lane[0] += double(a[x]) * double(b[x]);
  return ab.sum();
}

/// p.q, r.p and p.p in one pass.
DEM_VECTORISED void products_span(const float* p, const float* q, const float* r, Span span,
                                  double* out) {
  Lanes pq, rp, pp;
  int x = span.begin;
  for (; x + 8 <= span.end; x += 8)
    for (int l = 0; l < 8; ++l) {
      const double at = double(p[x + l]);
      pq.lane[l] += at * double(q[x + l]);
      rp.lane[l] += at * double(r[x + l]);
      pp.lane[l] += at * at;
    }
  for (; x < span.end; ++x) {
    const double at = double(p[x]);
    pq.lane[0] += at * double(q[x]);
    rp.lane[0] += at * double(r[x]);
    pp.lane[0] += at * at;
  }
  out[0] += pq.sum();
  out[1] += rp.sum();
  out[2] += pp.sum();
}

DEM_VECTORISED void direction_span(const float* s, float beta, Span span, float* p) {
  DEM_INDEPENDENT
  for (int x = span.begin; x < span.end; ++x) p[x] = s[x] + beta * p[x];
}

DEM_VECTORISED void advance_span(const float* p, double alpha, Span span, double* x) {
  DEM_INDEPENDENT
  for (int i = span.begin; i < span.end; ++i) x[i] += alpha * double(p[i]);
}

/// The sum over rows of row_sum(y): rows in parallel, their sums added in order.
template <class RowSum>
double sum_rows(int rows, const RowSum& row_sum) {
  std::vector<double> sums(std::size_t(rows), 0.);
  parallel_for(0, rows, row_grain, [&](int y) { sums[std::size_t(y)] = row_sum(y); });
  double total = 0;
  for (const double s : sums) total += s;
  return total;
}

}  // namespace

SplineSolver::SplineSolver(const Springs& springs, double X, const Mask& free, Grid<float> w,
                           const Mask& breaks)
    : multigrid_(springs, X, free, std::move(w), breaks),
      unknowns_(count(free)),
      r_(free.size()),
      p_(free.size()),
      q_(free.size()) {}

void SplineSolver::residual(const Grid<double>& x, const Grid<float>* f) {
  const Level& level = multigrid_.finest();
  const std::vector<double> zeros(std::size_t(Grid<double>::stride_for(level.size.cols)));
  parallel_for(0, level.size.rows, row_grain, [&](int y) {
    const auto around = rows_around(x, y, zeros.data() + Grid<double>::margin);
    for (const Span span : level.spans.row(y))
      residual_row(level.A.exact_row(y), around.data(), f ? f->row(y) : nullptr,
                   level.w.empty() ? nullptr : level.w.row(y), level.dinv.row(y), span,
                   level.size.cols, r_.row(y));
    for_cut_cells(level, y, around.data(), [&](int i, double Ax) {
      const double w = level.w.empty() ? 0 : double(level.w.row(y)[i]);
      r_.row(y)[i] = float((f ? double(f->row(y)[i]) : 0) - Ax - w * x.row(y)[i]);
    });
  });
  if (tensor_) tensor_->add(x, -1, level.dinv, r_);
}

double SplineSolver::dot(const Grid<float>& a, const Grid<float>& b) const {
  const Level& level = multigrid_.finest();
  return sum_rows(level.size.rows, [&](int y) {
    double sum = 0;
    for (const Span span : level.spans.row(y)) sum += dot_span(a.row(y), b.row(y), span);
    return sum;
  });
}

void SplineSolver::next_direction(const Grid<float>& s, float beta) {
  const Level& level = multigrid_.finest();
  parallel_for(0, level.size.rows, row_grain, [&](int y) {
    for (const Span span : level.spans.row(y)) direction_span(s.row(y), beta, span, p_.row(y));
  });
}

SplineSolver::Products SplineSolver::apply() {
  const Level& level = multigrid_.finest();
  const std::vector<float> zeros(std::size_t(Grid<float>::stride_for(level.size.cols)));
  std::vector<std::array<double, 3>> sums(std::size_t(level.size.rows));
  const auto multiply = [&](int y) {
    const auto around = rows_around(p_, y, zeros.data() + Grid<float>::margin);
    for (const Span span : level.spans.row(y))
      apply_row(level.A.row(y), around.data(), level.w.empty() ? nullptr : level.w.row(y),
                level.dinv.row(y), span, level.size.cols, q_.row(y));
    for_cut_cells(level, y, around.data(), [&](int i, float Ap) {
      q_.row(y)[i] = level.w.empty() ? Ap : Ap + level.w.row(y)[i] * p_.row(y)[i];
    });
  };
  const auto sum_up = [&](int y) {
    for (const Span span : level.spans.row(y))
      products_span(p_.row(y), q_.row(y), r_.row(y), span, sums[std::size_t(y)].data());
  };
  if (tensor_) {
    parallel_for(0, level.size.rows, row_grain, multiply);
    tensor_->add(p_, 1, level.dinv, q_);
    parallel_for(0, level.size.rows, row_grain, sum_up);
  } else {
    parallel_for(0, level.size.rows, row_grain, [&](int y) {
      multiply(y);
      sum_up(y);
    });
  }
  Products total;
  for (const auto& [pAp, rp, pp] : sums) {
    total.pAp += pAp;
    total.rp += rp;
    total.pp += pp;
  }
  return total;
}

void SplineSolver::advance(Grid<double>& x, double alpha) const {
  const Level& level = multigrid_.finest();
  parallel_for(0, level.size.rows, row_grain, [&](int y) {
    for (const Span span : level.spans.row(y)) advance_span(p_.row(y), alpha, span, x.row(y));
  });
}

Solved SplineSolver::solve(Grid<double>& x, const Grid<float>* f, const SolveLimits& limits,
                           const Run& run) {
  Solved solved;
  const double n = std::max(1., double(unknowns_));
  double pAp = 0, change2 = 0, last_step = 0, last_rate = fastest_rate;
  residual(x, f);
  while (!solved.converged && solved.iterations < limits.max_iterations) {
    // Precondition; make the direction conjugate to the last one.
    const Grid<float>& s = multigrid_.v_cycle(r_);
    next_direction(s, pAp > 0 ? float(-dot(s, q_) / pAp) : 0.f);
    const Products products = apply();
    const bool restarted = pAp == 0;
    pAp = products.pAp;
    if (!(pAp > 0)) {
      // Nothing is left in this direction: start anew once, to see whether anything is left at all.
      pAp = 0;
      if (!restarted) continue;
      solved.converged = true;
      solved.estimated_error_m = 0;
      break;
    }
    const double alpha = products.rp / pAp;
    advance(x, alpha);
    residual(x, f);
    ++solved.iterations;

    // What is left, from the length of the steps and how fast they shrink.
    const double step = std::abs(alpha) * std::sqrt(products.pp / n);
    change2 += step * step;
    const bool first = solved.iterations == 1;  // nothing to compare with: far from done
    const double rate =
        first ? slowest_rate
              : std::clamp(step / std::max(last_step, 1e-300), fastest_rate, slowest_rate);
    const double slower = std::max(rate, last_rate);
    solved.estimated_error_m = step * slower / (1 - slower);
    last_step = step;
    last_rate = first ? fastest_rate : rate;
    const double tolerance =
        std::max(limits.tolerance_m, limits.relative_tolerance * std::sqrt(change2));
    solved.converged = solved.estimated_error_m <= tolerance;
    run.report(std::min(1., double(solved.iterations) / limits.max_iterations),
               "solving the spline");
  }
  solved.change_m = std::sqrt(change2);
  solved.residual_m = std::sqrt(dot(r_, r_) / n) / multigrid_.finest().A.interior_diagonal();
  return solved;
}

}  // namespace dem::spline
