#include "dem/spline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <numbers>
#include <string>

#include "dem/breaklines.h"
#include "numeric/random.h"
#include "spline/multigrid.h"
#include "spline/springs.h"
#include "spline/tensor.h"

namespace dem {
using namespace numeric;
using namespace spline;
namespace {

// ---- Terrains and masks

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
  int iterations = 60;  // that are enough
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
  const auto broken = [&](std::string name, double part, const Breakline& line) {
    variant(std::move(name), part, [](auto&) {});
    all.back().dem.breaks = Breaklines({line}, usual).breaks();
  };
  broken("straight breakline", 0.1, {{-1, 61}, {12.4, 30.7}});
  broken("breakline that ends", 0.1, {{20.3, 41.2}, {-1, 33.3}});
  broken("ring", 0.1, {{12, 40, 33, 9, 12}, {8, 11, 40, 35, 8}});
  broken("zigzag", 0.05, {{5, 20, 25, 26, 50, 12}, {20, 10, 40, 12, 44, 44}});
  all.back().options.max_iterations = all.back().iterations = 200;  // wedges, a cell or two wide
  broken("breakline among many", 0.5, {{-1, 61}, {12.4, 30.7}});
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

/// Whether no edge between two cells of the spring (i, j) at (x, y) is broken.
bool is_whole(const Dem& dem, int x, int y, int i, int j) {
  if (dem.breaks.empty()) return true;
  for (int b = 0; b <= j; ++b)
    for (int a = 0; a <= i; ++a) {
      if (a < i && (dem.breaks(x + a, y + b) & break_east)) return false;
      if (b < j && (dem.breaks(x + a, y + b) & break_south)) return false;
    }
  return true;
}

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
          if (is_whole(dem, x, y, i, j))
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
  // As far as it explains the heights: slopes shrink with R^2, to nothing at a half.
  const double R2 = h.squaredNorm() > 0 ? slope.dot(P.transpose() * h) / h.squaredNorm() : 0;
  slope *= std::clamp(2 * R2 - 1, 0.0, 1.0);
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
  EXPECT_LE(figure(filled, "iterations"), c.iterations);
  RecordProperty("iterations", int(figure(filled, "iterations")));
}

TEST_P(EveryMask, KeepsKnownCellsBitForBit) {
  const Case& c = GetParam();
  const Filled filled = fill_spline(c.dem, c.options);
  for (int y = 0; y < c.dem.size().rows; ++y)
    for (int x = 0; x < c.dem.size().cols; ++x)
      if (c.dem.known(x, y)) {
        ASSERT_EQ(filled.z(x, y), c.dem.z(x, y)) << x << ", " << y;
      }
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

// ---- Whole surfaces, default options

Dem random_tenth(Size size) {
  return masked(terrain_dem(size), [](int x, int y) { return chance(0.1, x, y); });
}

TEST(FillSpline, ReturnsTheSameBitsForAnyNumberOfThreads) {
  SplineOptions options;
  options.sigma = SplineSigma::law;
  for (const Dem& dem :
       {random_tenth({131, 118}),
        masked(terrain_dem({120, 150}), [](int x, int y) { return x % 90 < 40 || y % 70 < 30; })}) {
    const Filled one = fill_spline(dem, options, {1, {}});
    for (const int threads : {2, 5}) {
      const Filled many = fill_spline(dem, options, {threads, {}});
      EXPECT_TRUE(many.z == one.z) << threads;
      EXPECT_TRUE(many.sigma == one.sigma) << threads;
    }
  }
}

TEST(FillSpline, ReturnsAConstantExactly) {
  Dem dem = random_tenth({70, 50});
  for (float& z : dem.z.cells()) z = -13.7f;
  const Filled filled = fill_spline(dem);
  EXPECT_THAT(filled.z.cells(), testing::Each(-13.7f));
}

TEST(FillSpline, ReturnsAPlane) {
  Dem dem = random_tenth({150, 120});
  dem.spacing = {1.4, 1};
  const auto plane = [](int x, int y) { return float(-40 + 0.75 * x - 1.25 * y); };
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 150; ++x) dem.z(x, y) = plane(x, y);
  const Filled filled = fill_spline(dem);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 150; ++x) ASSERT_NEAR(filled.z(x, y), plane(x, y), 1e-4) << x << ", " << y;
}

TEST(FillSpline, ReturnsACompleteDemAsItIs) {
  const Dem dem = terrain_dem({40, 30});
  const Filled filled = fill_spline(dem);
  EXPECT_TRUE(filled.z == dem.z);
  EXPECT_EQ(figure(filled, "iterations"), 0);
}

TEST(FillSpline, FillsASingleCellDem) {
  Dem dem{Raster<float>({1, 1}, 5), Mask({1, 1}, 1), {}, {}};
  EXPECT_EQ(fill_spline(dem).z(0, 0), 5);
}

TEST(FillSpline, LetsNoNanSpread) {
  // masked() hides unknown cells behind NaN.
  for (const double part : {0.001, 0.1, 0.9}) {
    const Dem dem = masked(terrain_dem({90, 80}),
                           [&](int x, int y) { return chance(part, x, y) || x + y == 0; });
    const Filled filled = fill_spline(dem);
    for (const float z : filled.z.cells()) ASSERT_TRUE(std::isfinite(z)) << part;
  }
}

TEST(FillSpline, KeepsAnOutlierLocal) {
  SplineOptions options;
  options.parameters = SplineParameters::manual;
  options.adaptive = false;
  options.tolerance_m = 1e-3;
  const Dem clean = masked(terrain_dem({160, 160}),
                           [](int x, int y) { return chance(0.3, x, y) || (x == 80 && y == 80); });
  Dem dirty = clean;
  dirty.z(80, 80) = 1e6f;
  const Filled without = fill_spline(clean, options), with = fill_spline(dirty, options);
  EXPECT_EQ(figure(with, "converged"), 1);
  // Between known cells at every other place, the influence falls by half each cell or two: forty
  // cells away less than a millionth of the outlier is left.
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 160; ++x)
      if (std::hypot(x - 80, y - 80) > 40) {
        ASSERT_NEAR(with.z(x, y), without.z(x, y), 1) << x << ", " << y;
      }
}

TEST(Tensor, IsTheGradientOfItsEnergy) {
  // Symmetric, and with the plate it stays positive: both read off the whole matrix of a small
  // grid.
  const Size size{13, 11};
  const int n = int(size.cells());
  for (const double X : {1., 1.9}) {
    Mask free(size, 1);
    const Springs plate = terrain_springs(1e-9, 1, 0, X, false);
    Multigrid grids(plate, X, free, {});
    Grid<double> z(size);
    for (int y = 0; y < size.rows; ++y)
      for (int x = 0; x < size.cols; ++x) z.row(y)[x] = double(terrain(x, y));
    Tensor tensor(size, grids.finest().spans, X);
    tensor.estimate(z, 1.2);
    Eigen::MatrixXd T(n, n), A(n, n);
    for (int i = 0; i < n; ++i) {
      Grid<double> unit(size);
      Grid<float> out(size);
      unit.row(i / size.cols)[i % size.cols] = 1;
      tensor.add(unit, 1, grids.finest().dinv, out);
      for (int j = 0; j < n; ++j) {
        const int x = j % size.cols, y = j / size.cols;
        T(i, j) = double(out.row(y)[x]);
        const int dx = i % size.cols - x, dy = i / size.cols - y;
        A(i, j) = std::abs(dx) + std::abs(dy) <= 3 ? grids.finest().A.at(x, y, dx, dy) : 0;
      }
    }
    EXPECT_GT(T.norm(), 1);
    EXPECT_LT((T - T.transpose()).norm(), 1e-5 * T.norm());
    const Eigen::MatrixXd sum = (A + T + (A + T).transpose()) / 2;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(sum);
    EXPECT_GT(eigen.eigenvalues()[0], -1e-5 * eigen.eigenvalues()[n - 1]);
  }
}

TEST(FillSpline, BendingSpringsFollowARidgeThroughAGap) {
  // A straight diagonal ridge, interrupted by a gap.
  const Size size{120, 120};
  Dem truth{Raster<float>(size), Mask(size, 1), {}, {}};
  for (int y = 0; y < size.rows; ++y)
    for (int x = 0; x < size.cols; ++x)
      truth.z(x, y) = float(300 * std::exp(-std::abs(x - y) / 6.));
  const Dem dem = masked(truth, [](int x, int y) { return std::hypot(x - 60, y - 60) > 18; });
  const auto rmse = [&](bool adaptive) {
    SplineOptions options;
    options.parameters = SplineParameters::manual;
    options.adaptive = adaptive;
    const Filled filled = fill_spline(dem, options);
    double sum = 0, n = 0;
    for (int y = 0; y < size.rows; ++y)
      for (int x = 0; x < size.cols; ++x)
        if (!dem.known(x, y)) sum += std::pow(filled.z(x, y) - truth.z(x, y), 2), ++n;
    return std::sqrt(sum / n);
  };
  EXPECT_LT(rmse(true), 0.8 * rmse(false));
}

TEST(FillSpline, SmoothsKnownCellsOnlyWhenAsked) {
  SplineOptions options;
  options.parameters = SplineParameters::manual;
  options.nugget = 5;
  const Dem dem = random_tenth({60, 60});
  const Filled kept = fill_spline(dem, options);
  options.smooth_known = true;
  const Filled smoothed = fill_spline(dem, options);
  int changed = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      if (!dem.known(x, y)) continue;
      ASSERT_EQ(kept.z(x, y), dem.z(x, y));
      changed += smoothed.z(x, y) != dem.z(x, y);
    }
  EXPECT_GT(changed, 100);
}

TEST(FillSpline, AZeroNoiseMakesACellExact) {
  SplineOptions options;
  options.parameters = SplineParameters::manual;
  options.nugget = 5;
  options.smooth_known = true;
  const Dem dem = random_tenth({60, 60});
  Raster<float> noise(dem.size(), 1);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 60; ++x) noise(x, y) = 0;
  const Filled filled = fill_spline(dem, noise, options);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 60; ++x)
      if (dem.known(x, y)) {
        ASSERT_NEAR(filled.z(x, y), dem.z(x, y), 1e-4);
      }
}

// ---- Uncertainty

TEST(SplineSigma, IsZeroAtDataAndGrowsAwayFromThem) {
  SplineOptions options;
  for (const SplineSigma kind : {SplineSigma::law, SplineSigma::simulation}) {
    options.sigma = kind;
    const Dem dem = masked(terrain_dem({120, 100}), [](int x, int) { return x < 20 || x > 100; });
    const Filled filled = fill_spline(dem, options);
    for (int x = 0; x < 20; ++x) ASSERT_EQ(filled.sigma(x, 50), 0);
    for (int x = 20; x <= 100; ++x) ASSERT_GT(filled.sigma(x, 50), 0) << x;
    EXPECT_GT(filled.sigma(60, 50), 2 * filled.sigma(21, 50));  // forty cells away, and two
  }
}

TEST(FillSpline, ScalesTheRoughnessOfARealisation) {
  const Dem dem = masked(terrain_dem({96, 80}), [](int x, int) { return x < 20 || x > 70; });
  const auto rms_from_smooth = [&](double roughness) {
    const Filled smooth = fill_spline(dem),
                 rough = fill_spline(dem, {.realisation = 1, .roughness = roughness});
    double sum = 0;
    for (std::size_t i = 0; i < dem.size().cells(); ++i) {
      const double d = double(rough.z.cells()[i]) - double(smooth.z.cells()[i]);
      if (dem.known.cells()[i]) {
        EXPECT_EQ(d, 0);
      }
      sum += d * d;
    }
    return std::sqrt(sum);
  };
  EXPECT_EQ(rms_from_smooth(0), 0);
  const double once = rms_from_smooth(1);
  EXPECT_GT(once, 1);
  EXPECT_NEAR(rms_from_smooth(2), 2 * once, 1e-3 * once);
}

TEST(FillSpline, IsLessCertainWhereTheGroundIsRough) {
  // Bumps in the west, a gentle slope in the east, a tenth of the cells known.
  Dem dem{Raster<float>({128, 64}), Mask({128, 64}), {}, {}};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) {
      const double bump = double(random_bits(1, 0, x / 3, y / 3) % 1000) / 10;
      dem.z(x, y) = float(x < 64 ? 500 + bump : 500 + 0.1 * x);
      dem.known(x, y) = random_bits(2, 0, x, y) % 10 == 0;
    }
  SplineOptions options;
  options.sigma = SplineSigma::law;
  const Filled filled = fill_spline(dem, options);
  double west = 0, east = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) (x < 64 ? west : east) += double(filled.sigma(x, y));
  EXPECT_GT(west, 5 * east);
}

TEST(SplineSigma, IsTheSpreadOfDrawsFromTheSpringsWhenTheTruthIsOne) {
  // Truth drawn from the springs themselves: sigma must be right without any calibration.
  // Parameters by hand, so that no cell is hidden.
  SplineOptions draw;
  draw.parameters = SplineParameters::manual;
  draw.adaptive = false;
  draw.L1_rows = 40;
  draw.realisation = 77;
  Dem seed =
      masked(terrain_dem({150, 150}), [](int x, int y) { return x % 149 == 0 && y % 149 == 0; });
  const Dem truth{fill_spline(seed, draw).z, Mask({150, 150}, 1), {}, {}};
  const Dem dem = masked(truth, [](int x, int y) { return chance(0.05, x, y); });
  SplineOptions options = draw;
  options.realisation = 0;
  options.sigma = SplineSigma::simulation;
  const Filled filled = fill_spline(dem, options);
  double one = 0, two = 0, n = 0;
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 150; ++x) {
      if (dem.known(x, y)) continue;
      const double sigmas =
          std::abs(double(filled.z(x, y)) - double(truth.z(x, y))) / double(filled.sigma(x, y));
      one += sigmas < 1;
      two += sigmas < 2;
      ++n;
    }
  // 0.68 and 0.95 for a normal law; neighbours are alike, so some hundred independent errors: +-
  // 0.05.
  EXPECT_NEAR(one / n, 0.68, 0.06);
  EXPECT_NEAR(two / n, 0.95, 0.04);
}

TEST(SplineRealisation, MeetsTheDataAndIsRougherThanTheSpline) {
  const Dem dem = random_tenth({120, 100});
  SplineOptions options;
  const Filled spline = fill_spline(dem, options);
  options.realisation = 1;
  const Filled first = fill_spline(dem, options);
  options.realisation = 2;
  const Filled second = fill_spline(dem, options);
  const auto roughness = [](const Raster<float>& z) {
    double sum = 0;
    for (int y = 0; y < z.rows(); ++y)
      for (int x = 1; x + 1 < z.cols(); ++x)
        sum += std::pow(z(x - 1, y) - 2 * z(x, y) + z(x + 1, y), 2);
    return sum;
  };
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 120; ++x)
      if (dem.known(x, y)) {
        ASSERT_EQ(first.z(x, y), dem.z(x, y));
      }
  EXPECT_GT(roughness(first.z), 1.1 * roughness(spline.z));
  EXPECT_FALSE(first.z == second.z);
}

// ---- Choices and errors

TEST(SplineParametersChosen, FollowTheGround) {
  // Noise from cell to cell wants springs that tie only neighbours; rolling hills want smooth ones.
  const Size size{160, 160};
  Dem noise{Raster<float>(size), Mask(size, 1), {}, {}}, hills = noise;
  for (int y = 0; y < size.rows; ++y)
    for (int x = 0; x < size.cols; ++x) {
      noise.z(x, y) = float(20 * signed_uniform(random_bits(3, 0, x, y)));
      hills.z(x, y) = float(100 * std::sin(x * 0.11) * std::cos(y * 0.13));
    }
  const auto at = [](int x, int y) { return chance(0.3, x, y); };
  EXPECT_LE(figure(fill_spline(masked(noise, at)), "L1"), 6);
  EXPECT_GT(figure(fill_spline(masked(hills, at)), "L3"), 0);
}

TEST(SplineOptionsCheck, RefusesLengthsThatWouldBeIgnored) {
  SplineOptions options;
  options.L1_rows = 30;
  EXPECT_THROW(fill_spline(terrain_dem({5, 5}), options), std::invalid_argument);
  options.parameters = SplineParameters::manual;
  EXPECT_NO_THROW(fill_spline(terrain_dem({5, 5}), options));
}

TEST(SplineOptionsCheck, RefusesBadInput) {
  Dem dem = terrain_dem({5, 5});
  dem.spacing.dx_m = 0;
  EXPECT_THROW(fill_spline(dem), std::invalid_argument);
  dem.spacing.dx_m = 1;
  EXPECT_THROW(fill_spline(dem, Raster<float>({4, 5}), {}), std::invalid_argument);
  dem.known = Mask(dem.size());
  EXPECT_THROW(fill_spline(dem), std::invalid_argument);
}

TEST(FillSpline, StopsWhenAsked) {
  dem::Run run;
  run.progress = [](double part, std::string_view) { return part < 0.5; };
  EXPECT_THROW(fill_spline(random_tenth({80, 80}), {}, run), Cancelled);
}

}  // namespace
}  // namespace dem
