#include "dem/spline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <numbers>
#include <string>

#include "multigrid.h"
#include "random.h"
#include "springs.h"

namespace dem {
namespace {

// ---- Terrains and masks ------------------------------------------------------------------------

/// Rolling, rough ground with a slope and a cliff: nothing that a spline meets by luck.
float terrain(int x, int y) {
  const double rough = 3 * signed_uniform(random_bits(5, 0, x, y));
  const double cliff = x + 2 * y > 90 ? 60 : 0;
  return float(800 + 2.5 * x - 1.5 * y + 40 * std::sin(x * 0.21) * std::cos(y * 0.17) + rough +
               cliff);
}

Dem terrain_dem(Size size, Spacing spacing = {}) {
  Dem dem{Raster<float>(size), Mask(size, 1), {}, spacing};
  for (int y = 0; y < size.rows; ++y)
    for (int x = 0; x < size.cols; ++x) dem.z(x, y) = terrain(x, y);
  return dem;
}

/// Keeps the known cells for which keep(x, y) holds; hides the others behind a value that must not
/// leak.
template <class Keep>
Dem masked(Dem dem, const Keep& keep) {
  for (int y = 0; y < dem.size().rows; ++y)
    for (int x = 0; x < dem.size().cols; ++x)
      if (!keep(x, y)) {
        dem.known(x, y) = 0;
        dem.z(x, y) = std::nanf("");
      }
  return dem;
}

bool chance(double part, int x, int y) {
  return signed_uniform(random_bits(11, 1, x, y)) < 2 * part - 1;
}

struct Case {
  std::string name;
  Dem dem;
  SplineOptions options = {};
};

std::vector<Case> cases() {
  const Size usual{61, 48};
  const auto at = [](double part) { return [part](int x, int y) { return chance(part, x, y); }; };
  std::vector<Case> all{
      {"half", masked(terrain_dem(usual), at(0.5))},
      {"tenth", masked(terrain_dem(usual), at(0.1))},
      {"hundredth", masked(terrain_dem(usual), at(0.01))},
      {"nine tenths", masked(terrain_dem(usual), at(0.9))},
      {"giant void",
       masked(terrain_dem(usual), [](int x, int y) { return x < 2 || y < 1 || x > 58; })},
      {"island", masked(terrain_dem(usual),
                        [](int x, int y) { return x > 20 && x < 30 && y > 9 && y < 20; })},
      {"tracks",
       masked(terrain_dem(usual), [](int x, int y) { return (x + 2 * y) % 37 == 0 || y == 30; })},
      {"contours",
       masked(terrain_dem(usual), [](int x, int y) { return int(terrain(x, y)) % 20 == 0; })},
      {"single cell", masked(terrain_dem(usual), [](int x, int y) { return x == 17 && y == 40; })},
      {"two cells",
       masked(terrain_dem(usual), [](int x, int y) { return y == 9 && (x == 5 || x == 50); })},
      {"collinear", masked(terrain_dem(usual), [](int x, int y) { return x == 2 * y; })},
      {"all but one", masked(terrain_dem(usual), [](int x, int y) { return x != 30 || y != 20; })},
      {"corner missing", masked(terrain_dem(usual), [](int x, int y) { return x > 3 || y > 3; })},
      {"one row", masked(terrain_dem({300, 1}), at(0.1))},
      {"one column", masked(terrain_dem({1, 300}), at(0.1))},
      {"two rows", masked(terrain_dem({90, 2}), at(0.1))},
      {"2 x 2", masked(terrain_dem({2, 2}), [](int x, int y) { return x + y == 1; })},
      {"5 x 6", masked(terrain_dem({5, 6}), at(0.2))},
      {"8 x 7", masked(terrain_dem({8, 7}), at(0.2))},
      {"even sides", masked(terrain_dem({64, 50}), at(0.03))},
      {"wide cells", masked(terrain_dem({40, 90}, {3, 1}), at(0.05))},
      {"tall cells", masked(terrain_dem({90, 40}, {1, 3}), at(0.05))},
      {"one cell in wide cells",
       masked(terrain_dem({40, 60}, {1.4, 1}), [](int x, int y) { return x == 3 && y == 3; })},
  };
  for (Case& c : all) {
    c.options.parameters = SplineParameters::manual;
    c.options.adaptive = false;
  }
  const auto variant = [&](std::string name, double part, auto change) {
    Case c{std::move(name), masked(terrain_dem(usual), at(part)), {}};
    c.options.parameters = SplineParameters::manual;
    c.options.adaptive = false;
    change(c.options);
    all.push_back(c);
  };
  variant("no membrane", 0.05, [](auto& o) { o.L1_rows = 0; });
  variant("no third order", 0.05, [](auto& o) { o.L3_rows = 0; });
  variant("raw", 0.3, [](auto& o) {
    o.L3_rows = 0;
    o.fourth_order = false;
  });
  variant("plate alone", 0.05, [](auto& o) { o.L1_rows = o.L3_rows = 0; });
  variant("short membrane", 0.05, [](auto& o) { o.L1_rows = 6; });
  variant("nugget", 0.1, [](auto& o) { o.nugget = 0.5; });
  variant("small nugget", 0.1, [](auto& o) { o.nugget = 1e-3; });
  variant("large nugget", 0.3, [](auto& o) { o.nugget = 100; });
  return all;
}

// ---- The oracle: the same energy, solved by a sparse direct method
// ---------------------------------

/// Everything is written anew from the definition: springs as rows of a matrix, no stencil.
Eigen::VectorXd direct_solution(const Dem& dem, const SplineOptions& o) {
  const int cols = dem.size().cols, rows = dem.size().rows, n = cols * rows;
  const double X = std::pow(dem.spacing.dy_m / dem.spacing.dx_m, 2);
  const double L1 = o.L1_rows > 0 ? o.L1_rows : 1000 * std::hypot(cols / std::sqrt(X), rows);
  const double a1 = std::pow(2 * std::numbers::pi / L1, 2);
  const double a3 = std::pow(o.L3_rows / (2 * std::numbers::pi), 2);
  const double a2 = o.a2;
  const double e1 = o.fourth_order ? a1 / 12 : 0, e2 = o.fourth_order ? a2 / 6 : 0;
  const double weights[4][4] = {{0, a1, a2 + e1, a3 + e2},
                                {a1 * X, 2 * a2 * X, 3 * a3 * X + e2 * X, 0},
                                {a2 * X * X + e1 * X, 3 * a3 * X * X + e2 * X, 0, 0},
                                {a3 * X * X * X + e2 * X * X, 0, 0, 0}};
  const double binomial[4][4] = {{1, 0, 0, 0}, {-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};

  std::vector<Eigen::Triplet<double>> entries;
  int springs = 0;
  for (int i = 0; i <= 3; ++i)
    for (int j = 0; i + j <= 3; ++j) {
      if (weights[i][j] == 0) continue;
      for (int y = 0; y + j < rows; ++y)
        for (int x = 0; x + i < cols; ++x, ++springs)
          for (int a = 0; a <= i; ++a)
            for (int b = 0; b <= j; ++b)
              entries.emplace_back(springs, (y + b) * cols + x + a,
                                   std::sqrt(weights[i][j]) * binomial[i][a] * binomial[j][b]);
    }
  Eigen::SparseMatrix<double> D(springs, n);
  D.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> A = D.transpose() * D;

  // The plane of the known cells, by least squares of minimum norm.
  std::vector<int> known, free;
  for (int i = 0; i < n; ++i) (dem.known(i % cols, i / cols) ? known : free).push_back(i);
  double mx = 0, my = 0, mz = 0;
  for (int i : known) mx += i % cols, my += i / cols, mz += double(dem.z(i % cols, i / cols));
  mx /= double(known.size()), my /= double(known.size()), mz /= double(known.size());
  Eigen::MatrixXd P(known.size(), 2);
  Eigen::VectorXd h(known.size());
  for (int k = 0; k < int(known.size()); ++k) {
    P(k, 0) = known[k] % cols - mx;
    P(k, 1) = known[k] / cols - my;
    h(k) = double(dem.z(known[k] % cols, known[k] / cols)) - mz;
  }
  const Eigen::Matrix2d PtP = P.transpose() * P;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(PtP);
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (int k = 0; k < 2; ++k)
    if (eigen.eigenvalues()[k] > 1e-9 * eigen.eigenvalues()[1])
      slope += eigen.eigenvectors().col(k) * eigen.eigenvectors().col(k).dot(P.transpose() * h) /
               eigen.eigenvalues()[k];
  Eigen::VectorXd plane(n), data = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i)
    plane[i] = mz + slope[0] * (i % cols - mx) + slope[1] * (i / cols - my);
  for (int i : known) data[i] = double(dem.z(i % cols, i / cols)) - plane[i];

  // Known cells as constraints, or as springs to the data.
  std::vector<int> at(n, -1);
  int unknowns = 0;
  for (int i = 0; i < n; ++i)
    if (o.nugget > 0 || !dem.known(i % cols, i / cols)) at[i] = unknowns++;
  Eigen::SparseMatrix<double> reduced(unknowns, unknowns);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(unknowns);
  std::vector<Eigen::Triplet<double>> kept;
  for (int c = 0; c < n; ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator it(A, c); it; ++it) {
      const int r = int(it.row());
      if (at[r] < 0) continue;
      if (at[c] >= 0)
        kept.emplace_back(at[r], at[c], it.value());
      else
        f[at[r]] -= it.value() * data[c];
    }
  if (o.nugget > 0)
    for (int i : known) {
      kept.emplace_back(at[i], at[i], 1 / o.nugget);
      f[at[i]] += data[i] / o.nugget;
    }
  reduced.setFromTriplets(kept.begin(), kept.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(reduced);
  EXPECT_EQ(factor.info(), Eigen::Success);
  Eigen::VectorXd v = factor.solve(f);
  v += factor.solve(Eigen::VectorXd(f - reduced * v));  // one refinement
  Eigen::VectorXd z = data + plane;
  for (int i = 0; i < n; ++i)
    if (at[i] >= 0) z[i] = v[at[i]] + plane[i];
  return z;
}

double figure(const Filled& filled, std::string_view name) {
  for (const Figure& f : filled.report)
    if (f.name == name) return f.value;
  ADD_FAILURE() << "no figure " << name;
  return 0;
}

/// Root mean square of got - want over the unknown cells, and the largest.
struct Difference {
  double rms = 0, largest = 0;
};
Difference difference(const Dem& dem, const Raster<float>& got, const Eigen::VectorXd& want) {
  Difference d;
  double n = 0;
  for (int y = 0; y < dem.size().rows; ++y)
    for (int x = 0; x < dem.size().cols; ++x) {
      if (dem.known(x, y)) continue;
      const double e = double(got(x, y)) - want[y * dem.size().cols + x];
      d.rms += e * e;
      d.largest = std::max(d.largest, std::isfinite(e) ? std::abs(e) : 1e300);
      ++n;
    }
  d.rms = std::sqrt(d.rms / std::max(n, 1.));
  return d;
}

class EveryMask : public testing::TestWithParam<Case> {};

TEST_P(EveryMask, EqualsTheSparseDirectSolution) {
  const Case& c = GetParam();
  SplineOptions options = c.options;
  options.tolerance_m = 1e-6;
  const Filled filled = fill_spline(c.dem, options);
  const Eigen::VectorXd want = direct_solution(c.dem, options);
  // Relative to the largest height; a float holds 6e-8 of it.
  EXPECT_LT(difference(c.dem, filled.z, want).largest, 1e-6 * want.cwiseAbs().maxCoeff());
  EXPECT_EQ(figure(filled, "converged"), 1);
  EXPECT_LE(figure(filled, "iterations"), 60);
  RecordProperty("iterations", int(figure(filled, "iterations")));
}

TEST_P(EveryMask, KeepsKnownCellsBitForBit) {
  const Case& c = GetParam();
  const Filled filled = fill_spline(c.dem, c.options);
  for (int y = 0; y < c.dem.size().rows; ++y)
    for (int x = 0; x < c.dem.size().cols; ++x)
      if (c.dem.known(x, y)) ASSERT_EQ(filled.z(x, y), c.dem.z(x, y)) << x << ", " << y;
}

TEST_P(EveryMask, EstimatesItsErrorHonestly) {
  const Case& c = GetParam();
  const Eigen::VectorXd want = direct_solution(c.dem, c.options);
  for (const double tolerance : {3., 0.3, 0.03}) {
    SplineOptions options = c.options;
    options.tolerance_m = tolerance;
    const Filled filled = fill_spline(c.dem, options);
    // The estimate may be somewhat low, never wildly; a float's rounding comes on top.
    EXPECT_LT(difference(c.dem, filled.z, want).rms, 2 * tolerance + 1e-3) << tolerance;
  }
}

INSTANTIATE_TEST_SUITE_P(FillSpline, EveryMask, testing::ValuesIn(cases()), [](const auto& test) {
  std::string name;
  for (const char c : test.param.name)
    if (std::isalnum(static_cast<unsigned char>(c))) name += c;
  return name;
});

}  // namespace
}  // namespace dem
