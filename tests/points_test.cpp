#include "dem/points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "dem/gridding.h"
#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Cells of 1 x 1 whose centres are (col, -row).
Lattice unit_lattice(int cols, int rows) { return {{}, {cols, rows}, {1, 1}}; }

Points one_point(double x, double y, float z) { return {{x}, {y}, {z}, {}, {}}; }

void add(Points& p, double x, double y, double z) {
  p.x.push_back(x);
  p.y.push_back(y);
  p.z.push_back(float(z));
}

double uniform(int i, int stream) {
  return 0.5 + signed_uniform(random_bits(3, std::uint64_t(stream), i, 0)) / 2;
}

/// Points at random places of a surface z(x, y).
template <class Surface>
Points scattered(int n, int cols, int rows, const Surface& surface) {
  Points p;
  for (int i = 0; i < n; ++i) {
    const double x = uniform(i, 0) * (cols - 1), y = -uniform(i, 1) * (rows - 1);
    add(p, x, y, surface(x, y));
  }
  return p;
}

TEST(BinPoints, KeepsPointsOnACentreBitForBit) {
  Points p;
  for (int i = 0; i < 40; ++i) add(p, i % 8, -(i / 8), 1000.1 * uniform(i, 5));
  const Binned b = bin_points(p, unit_lattice(8, 5));
  EXPECT_EQ(b.counts.cells, 40u);
  EXPECT_TRUE(b.off_centre.empty());
  for (int i = 0; i < 40; ++i) EXPECT_EQ(b.dem.z(i % 8, i / 8), p.z[std::size_t(i)]);
}

TEST(BinPoints, TakesTextRoundedToAMillionthOfACellAsTheCentre) {
  const Binned b = bin_points(one_point(3 + 9e-7, -2, 5), unit_lattice(8, 5));
  EXPECT_TRUE(b.off_centre.empty());
}

TEST(BinPoints, IsExactOnPlanes) {
  const auto plane = [](double x, double y) { return 100 + 3 * x - 7 * y; };
  for (const int n : {40, 400, 4000}) {
    const Binned b = bin_points(scattered(n, 60, 50, plane), unit_lattice(60, 50));
    for (int r = 0; r < 50; ++r)
      for (int c = 0; c < 60; ++c)
        if (b.dem.known(c, r)) {
          EXPECT_NEAR(b.dem.z(c, r), plane(c, -r), 2e-3);  // float sums
        }
  }
}

TEST(BinPoints, MovesHeightsToCentresBetterThanSnapping) {
  const auto hills = [](double x, double y) {
    return 50 * std::sin(x / 6) * std::cos(y / 5) + 30 * std::sin((x - y) / 9);
  };
  const Points p = scattered(600, 80, 80, hills);
  const auto rmse = [&](bool plane) {
    const Binned b = bin_points(p, unit_lattice(80, 80), {.plane = plane});
    double sum = 0;
    for (int r = 0; r < 80; ++r)
      for (int c = 0; c < 80; ++c)
        if (b.dem.known(c, r)) sum += std::pow(b.dem.z(c, r) - hills(c, -r), 2);
    return std::sqrt(sum / double(b.counts.cells));
  };
  EXPECT_LT(rmse(true), 0.5 * rmse(false));
}

TEST(BinPoints, CombinesAsAsked) {
  Points p;
  for (const double z : {7., 1., 5., 3.}) add(p, 1, -1, z);
  const auto z = [&](Combine how) {
    return bin_points(p, unit_lattice(3, 3), {.combine = how}).dem.z(1, 1);
  };
  EXPECT_EQ(z(Combine::mean), 4);
  EXPECT_EQ(z(Combine::min), 1);
  EXPECT_EQ(z(Combine::max), 7);
  EXPECT_EQ(z(Combine::median), 3);  // the lower one of two
}

TEST(BinPoints, WeighsTheMeanBySigmaAndByWeight) {
  Points p;
  add(p, 1, -1, 0);
  add(p, 1, -1, 10);
  p.sigma = {1, 2};
  const Binned by_sigma = bin_points(p, unit_lattice(3, 3));
  EXPECT_FLOAT_EQ(by_sigma.dem.z(1, 1), 2);                     // (0 / 1 + 10 / 4) / (1 + 1 / 4)
  EXPECT_FLOAT_EQ(by_sigma.sigma(1, 1), 1 / std::sqrt(1.25F));  // variances add inversely
  p.sigma.clear();
  p.weight = {1, 3};
  EXPECT_FLOAT_EQ(bin_points(p, unit_lattice(3, 3)).dem.z(1, 1), 7.5F);
}

TEST(BinPoints, CountsWhatFallsOutsideAndWhatShares) {
  Points p;
  add(p, -0.51, 0, 1);
  add(p, -0.49, 0, 1);
  add(p, 2.49, -1, 1);
  add(p, 2.51, -1, 1);
  add(p, 1, -1, 1);
  add(p, 1, -1, 1);  // the same again is no contradiction
  add(p, 1, -1, 2);
  add(p, 0, 0, std::numeric_limits<float>::quiet_NaN());
  const BinCounts n = bin_points(p, unit_lattice(3, 2)).counts;
  EXPECT_EQ(n.points, 8u);
  EXPECT_EQ(n.outside, 3u);  // and the one without a height
  EXPECT_EQ(n.cells, 3u);
  EXPECT_EQ(n.combined, 3u);
  EXPECT_EQ(n.duplicates, 1u);
}

TEST(BinPoints, OnALineFollowsTheSlopeAlongIt) {
  Points p;
  for (int i = 0; i < 30; ++i) add(p, i + 0.3, -10, 5 * (i + 0.3));
  const Binned b = bin_points(p, unit_lattice(31, 21));
  for (int c = 0; c < 30; ++c) EXPECT_NEAR(b.dem.z(c, 10), 5 * c, 1e-3);
}

TEST(BinPoints, OfOneOrTwoPointsIsFinite) {
  EXPECT_EQ(bin_points(one_point(1.2, -1.3, 5), unit_lattice(4, 4)).dem.z(1, 1), 5);
  Points p = one_point(0.2, 0, 5);
  add(p, 3.1, -3, 8);
  const Binned b = bin_points(p, unit_lattice(4, 4));
  EXPECT_EQ(b.counts.cells, 2u);
  EXPECT_TRUE(std::isfinite(b.dem.z(0, 0)));
}

TEST(BinPoints, InPartsIsTheSameAsAtOnce) {
  const Points p = scattered(5000, 90, 40, [](double x, double y) { return x * x - y; });
  for (const Combine how : {Combine::mean, Combine::max, Combine::median}) {
    PointBins bins(unit_lattice(90, 40), {.combine = how});
    for (std::size_t from = 0; from < p.size(); from += 700) {
      Points part;
      for (std::size_t i = from; i < std::min(p.size(), from + 700); ++i)
        add(part, p.x[i], p.y[i], double(p.z[i]));
      bins.add(part);
    }
    const Binned parts = bins.finish(),
                 whole = bin_points(p, unit_lattice(90, 40), {.combine = how});
    EXPECT_EQ(parts.dem.z, whole.dem.z);
    EXPECT_EQ(parts.dem.known, whole.dem.known);
  }
}

TEST(BinPoints, DoesNotDependOnThreads) {
  const Points p = scattered(200000, 700, 600, [](double x, double y) { return x * std::sin(y); });
  const Binned one = bin_points(p, unit_lattice(700, 600), {}, {.threads = 1});
  const Binned two = bin_points(p, unit_lattice(700, 600), {}, {.threads = 2});
  EXPECT_EQ(one.dem.z, two.dem.z);
  EXPECT_EQ(one.off_centre.size(), two.off_centre.size());
}

TEST(BinPoints, LeavesOutAbsurdHeightsAndKeepsCliffs) {
  Points p;
  for (int r = 0; r < 30; ++r)
    for (int c = 0; c < 30; ++c) add(p, c + 0.1, -r, c < 15 ? 2 * c : 300 + 2 * c);
  p.z[17 * 30 + 4] = 32767;
  p.z[3 * 30 + 20] = -9999;
  const Binned b = bin_points(p, unit_lattice(30, 30), {.outliers = 10});
  EXPECT_EQ(b.counts.outliers, 2u);
  EXPECT_EQ(b.dem.known(4, 17), 0);
  EXPECT_EQ(b.dem.known(20, 3), 0);
  EXPECT_NEAR(b.dem.z(5, 17), 10, 0.5);  // the outlier beside it does not tilt its plane
  EXPECT_EQ(bin_points(p, unit_lattice(30, 30)).counts.outliers, 0u);
}

TEST(BinPoints, RefusesWhatIsNoPoints) {
  const Lattice lattice = unit_lattice(3, 3);
  Points p = one_point(0, 0, 1);
  p.sigma = {0};
  EXPECT_THAT([&] { bin_points(p, lattice); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("sigma = 0; must be above 0")));
  p.sigma = {1, 1};
  EXPECT_THAT([&] { bin_points(p, lattice); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("sigma has 2 numbers; must have 1")));
  EXPECT_THAT(
      [&] {
        bin_points(one_point(0, 0, 1), {{}, {0, 3}, {}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("at least one cell")));
}

TEST(CellForDensity, IsHalfTheMeanDistanceRoundedDown) {
  EXPECT_DOUBLE_EQ(cell_for_density(1000, 1000, 10000), 5);   // 10 m apart
  EXPECT_DOUBLE_EQ(cell_for_density(1000, 1000, 2500), 10);   // 20 m
  EXPECT_DOUBLE_EQ(cell_for_density(1, 1, 1000000), 0.0005);  // 0.001 degrees
  EXPECT_EQ(cell_for_density(0, 10, 5), 0);
}

ChosenMethod method(const char* name) { return find_method(fill_methods(), name); }

TEST(FillPoints, PassesThroughPointsBetweenCells) {
  const auto hills = [](double x, double y) { return 40 * std::sin(x / 5) * std::cos(y / 6); };
  const Binned b = bin_points(scattered(300, 64, 64, hills), unit_lattice(64, 64));
  const auto miss = [&](int passes) {
    return fill_points(b, method("spline"), {.passes = passes}).misfit.rms_m;
  };
  const double none = miss(0), one = miss(1), three = miss(3);
  EXPECT_LT(one, 0.6 * none);
  EXPECT_LT(three, one);
}

TEST(FillPoints, KeepsPointsOnACentreWhateverTheMethod) {
  Points p = scattered(60, 33, 33, [](double x, double y) { return x + y * y; });
  for (std::size_t i = 0; i < p.size(); ++i)
    p.x[i] = std::round(p.x[i]), p.y[i] = std::round(p.y[i]);
  add(p, 5.3, -7.2, 40);
  const Binned b = bin_points(p, unit_lattice(33, 33));
  for (const auto& m : fill_methods()) {
    const Gridded g = fill_points(b, {&m, {}});
    for (int r = 0; r < 33; ++r)
      for (int c = 0; c < 33; ++c)
        if (b.dem.known(c, r) && !(c == 5 && r == 7)) {
          ASSERT_EQ(g.filled.z(c, r), b.dem.z(c, r)) << m.name;
        }
  }
}

TEST(FillPoints, TrustsPointsByTheirSigma) {
  // A smooth hill; every other point is 20 times as noisy as the rest.
  const auto hill = [](double x, double y) {
    return 200 * std::exp(-(std::pow(x - 40, 2) + std::pow(y + 40, 2)) / 800);
  };
  Points p = scattered(1500, 80, 80, hill);
  for (int i = 0; i < 1500; ++i) {
    const float sigma = i % 2 == 0 ? 0.5F : 10.F;
    const double normal = uniform(i, 7) + uniform(i, 8) + uniform(i, 9) - 1.5;  // variance 1/4
    p.z[std::size_t(i)] += float(2 * normal) * sigma;
    p.sigma.push_back(sigma);
  }
  const auto rmse = [&](const Points& points) {
    const Gridded g = fill_points(bin_points(points, unit_lattice(80, 80)), method("spline"));
    double sum = 0;
    for (int r = 0; r < 80; ++r)
      for (int c = 0; c < 80; ++c) sum += std::pow(g.filled.z(c, r) - hill(c, -r), 2);
    return std::sqrt(sum / 6400);
  };
  Points alike = p;
  alike.sigma.clear();
  EXPECT_LT(rmse(p), 0.5 * rmse(alike));
}

TEST(FillPoints, RefusesPassesBelowZero) {
  const Binned b = bin_points(one_point(1, -1, 1), unit_lattice(3, 3));
  EXPECT_THAT([&] { fill_points(b, method("mcmd"), {.passes = -1}); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("passes = -1; must be a whole number in [0, 100]")));
}

}  // namespace
}  // namespace dem
