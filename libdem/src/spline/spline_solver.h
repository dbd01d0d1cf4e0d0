#pragma once
// Conjugate gradients on the spline's normal equations. Private to the library.

#include "dem/run.h"
#include "spline/multigrid.h"
#include "spline/tensor.h"

namespace dem::spline {

struct SolveLimits {
  double tolerance_m = 0;         ///< stop when the estimated RMS error is at most this
  double relative_tolerance = 0;  ///< ... or this part of the change made so far
  int max_iterations = 100;
};

struct Solved {
  int iterations = 0;
  double estimated_error_m = 0;  ///< RMS over the unknowns, against the converged solution
  double change_m = 0;           ///< RMS length of the steps made
  double residual_m = 0;         ///< RMS of the residual over the stencil's diagonal
  bool converged = false;
};

/// The system (A + diag(w)) x = f on the free cells; elsewhere x is given.
class SplineSolver {
 public:
  /// `breaks`: as Dem::breaks; springs across them are cut.
  SplineSolver(const Springs& springs, double X, const Mask& free, Grid<float> w,
               const Mask& breaks = {});

  /// Adds the tensor's springs to A, from now on (null: takes them away). It must outlive the
  /// solves. The preconditioner stays that of the plain springs.
  void bend_with(const Tensor* tensor) { tensor_ = tensor; }

  const Level& finest() const { return multigrid_.finest(); }

  /// Improves x until the limits are met. `f`: right-hand side, or null for 0.
  Solved solve(Grid<double>& x, const Grid<float>* f, const SolveLimits& limits, const Run& run);

 private:
  struct Products {
    double pAp = 0, rp = 0, pp = 0;
  };

  void residual(const Grid<double>& x, const Grid<float>* f);
  double dot(const Grid<float>& a, const Grid<float>& b) const;
  void next_direction(const Grid<float>& s, float beta);
  Products apply();
  void advance(Grid<double>& x, double alpha) const;

  Multigrid multigrid_;
  const Tensor* tensor_ = nullptr;
  std::size_t unknowns_ = 0;
  Grid<float> r_, p_, q_;
};

}  // namespace dem::spline
