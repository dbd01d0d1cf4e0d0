#include "dem/breaklines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/gridding.h"
#include "dem/spline.h"
#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

double uniform(int i, int stream) {
  return 0.5 + signed_uniform(random_bits(9, std::uint64_t(stream), i, 0)) / 2;
}

/// A circle on a lattice.
Breakline circle(double col, double row, double radius, int corners = 60) {
  Breakline ring;
  for (int i = 0; i <= corners; ++i) {
    const double angle = 2 * std::numbers::pi * (i % corners) / corners;
    ring.col.push_back(col + radius * std::cos(angle));
    ring.row.push_back(row + radius * std::sin(angle));
  }
  return ring;
}

TEST(Breaklines, BreakTheEdgesTheyCross) {
  // Between columns 1 and 2, from above the lattice to below row 1.
  const Mask breaks = Breaklines({{{1.5, 1.5}, {-3, 1.2}}}, {4, 3}).breaks();
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 4; ++col)
      EXPECT_EQ(breaks(col, row), col == 1 && row < 2 ? break_east : 0) << col << ", " << row;
}

TEST(Breaklines, CountCentresOnALineToItsWestOrNorth) {
  const Mask upright = Breaklines({{{2, 2}, {-1, 5}}}, {5, 5}).breaks();
  const Mask level = Breaklines({{{-1, 5}, {2, 2}}}, {5, 5}).breaks();
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(upright(2, i), break_east);
    EXPECT_EQ(upright(1, i), 0);
    EXPECT_EQ(level(i, 2), break_south);
    EXPECT_EQ(level(i, 1), 0);
  }
}

TEST(Breaklines, OfARingLeaveNoWayOut) {
  // Rings through cell centres, and at random places.
  std::vector<Breakline> rings{{{10, 30, 30, 10, 10}, {10, 10, 25, 25, 10}},
                               {{10, 20, 30, 20, 10}, {20, 10, 20, 30, 20}},
                               {{5, 35, 20, 5}, {5, 14, 35, 5}}};
  for (int i = 0; i < 40; ++i)
    rings.push_back(circle(20 + uniform(i, 0), 20 + uniform(i, 1), 5 + 10 * uniform(i, 2), 3 + i));
  const Size size{41, 41};
  Mask known(size);
  known(0, 0) = 1;
  for (const Breakline& ring : rings) {
    const Mask closed = cells_closed_off(known, Breaklines({ring}, size).breaks());
    EXPECT_TRUE(closed(20, 20));
    EXPECT_FALSE(closed(40, 40));
    EXPECT_GT(count(closed), 20u);
  }
}

TEST(Breaklines, PartAPlaceFromItsCellsCentre) {
  const Breaklines lines({{{3.2, 3.2}, {-1, 5}}}, {8, 5});
  EXPECT_TRUE(lines.between(3, 2, 0.3, 0.1));
  EXPECT_FALSE(lines.between(3, 2, 0.1, 0.1));
  EXPECT_FALSE(lines.between(4, 2, -0.4, 0));
  EXPECT_FALSE(lines.between(6, 2, 0.4, 0.4));
  // A centre on the line lies to its west, as for the edges.
  const Breaklines through({{{3, 3}, {-1, 5}}}, {8, 5});
  EXPECT_TRUE(through.between(3, 2, 1e-9, 0));
  EXPECT_FALSE(through.between(3, 2, -0.4, 0));
}

TEST(Breaklines, RefuseWhatIsNoLine) {
  EXPECT_THAT(
      [] {
        Breaklines({{{1, 2}, {1}}}, {4, 4});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("2 columns and 1 rows")));
  EXPECT_THAT(
      [] {
        Breaklines({{{1, std::nan("")}, {1, 2}}}, {4, 4});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("no finite number")));
}

// ---- The spline across a cliff

/// Rolling ground; `cliff` higher south of a winding line.
struct Cliff {
  Size size{150, 140};
  double height_m = 100;

  double line(double col) const { return 60.3 + 18 * std::sin(col / 20) + 4 * std::sin(col / 6); }
  double at(double col, double row) const {
    return 300 + 15 * std::sin(col / 30) * std::cos(row / 35) + (row > line(col) ? height_m : 0);
  }
  Breaklines lines() const {
    Breakline line_on;
    for (int i = -4; i <= 4 * size.cols; ++i) {
      line_on.col.push_back(i / 4.);
      line_on.row.push_back(line(i / 4.));
    }
    return {{line_on}, size};
  }
  /// The truth at 3 % of the cells.
  Dem samples() const {
    Dem dem{Raster<float>(size), Mask(size), {}, {}};
    for (int row = 0; row < size.rows; ++row)
      for (int col = 0; col < size.cols; ++col)
        if (signed_uniform(random_bits(4, 2, col, row)) < 2 * 0.03 - 1) {
          dem.known(col, row) = 1;
          dem.z(col, row) = float(at(col, row));
        }
    return dem;
  }
  /// RMSE within 4 cells of the line, and elsewhere.
  std::pair<double, double> errors(const Raster<float>& z) const {
    double sum[2] = {}, n[2] = {};
    for (int row = 0; row < size.rows; ++row)
      for (int col = 0; col < size.cols; ++col) {
        const int beside = std::abs(row - line(col)) < 4;
        sum[beside] += std::pow(double(z(col, row)) - at(col, row), 2);
        ++n[beside];
      }
    return {std::sqrt(sum[1] / n[1]), std::sqrt(sum[0] / n[0])};
  }
};

TEST(FillSpline, IsAsExactBesideABreaklineAsFarFromIt) {
  const Cliff cliff;
  Dem dem = cliff.samples();
  const auto [beside_uncut, far_uncut] = cliff.errors(fill_spline(dem).z);
  dem.breaks = cliff.lines().breaks();
  const auto [beside, far] = cliff.errors(fill_spline(dem).z);
  EXPECT_GT(beside_uncut, 20);
  // At a free border a surface is less certain than amid data.
  EXPECT_LT(beside, 0.5);
  EXPECT_LT(far, 0.1);
  EXPECT_LT(far, far_uncut);
}

TEST(FillSpline, WithBreaklinesDoesNotDependOnThreads) {
  const Cliff cliff;
  Dem dem = cliff.samples();
  dem.breaks = cliff.lines().breaks();
  const Raster<float> one = fill_spline(dem, {}, {1, {}}).z, four = fill_spline(dem, {}, {4, {}}).z;
  EXPECT_TRUE(std::ranges::equal(one.cells(), four.cells()));
}

TEST(FillSpline, GoesOnIntoWhatBreaklinesCloseOffWithoutData) {
  // A plane, and a ring in which nothing is known; the jump at the cliff stays outside.
  const Size size{80, 80};
  Dem dem{Raster<float>(size), Mask(size), {}, {}};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      if (random_bits(1, 0, col, row) % 15 == 0 && std::hypot(col - 40, row - 40) > 12) {
        dem.known(col, row) = 1;
        dem.z(col, row) = float(100 + 2 * col - row);
      }
  dem.breaks = Breaklines({circle(40, 40, 11.3)}, size).breaks();
  const Filled filled = fill_spline(dem, {.sigma = SplineSigma::law});
  double closed_off = 0;
  for (const Figure& f : filled.report)
    if (f.name == "closed_off") closed_off = f.value;
  EXPECT_NEAR(closed_off, std::numbers::pi * 11.3 * 11.3, 25);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      ASSERT_NEAR(filled.z(col, row), 100 + 2 * col - row, 0.1) << col << ", " << row;
      ASSERT_EQ(filled.sigma(col, row) > 0, !dem.known(col, row));
    }
}

TEST(FillSpline, RefusesBreaksOfAnotherSize) {
  Dem dem{Raster<float>({4, 4}), Mask({4, 4}, 1), {}, {}};
  dem.breaks = Mask({3, 4});
  EXPECT_THAT([&] { fill_spline(dem); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("dem.breaks is 3 x 4")));
}

// ---- Points

TEST(PointBins, MoveNoHeightAlongAPlaneAcrossABreakline) {
  // Two level terraces; points anywhere in their cells.
  const Size size{60, 40};
  const auto height = [](double col) { return col < 30.3 ? 0.F : 100.F; };
  Points points;
  for (int i = 0; i < 4000; ++i) {
    const double col = uniform(i, 0) * 59, row = uniform(i, 1) * 39;
    points.x.push_back(col);
    points.y.push_back(-row);
    points.z.push_back(height(col));
  }
  const Breaklines line({{{30.3, 30.3}, {-1, 41}}}, size);
  const auto bin = [&](const Breaklines& lines) {
    PointBins bins({{}, size, {1, 1}}, {}, lines);
    bins.add(points);
    return bins.finish();
  };
  const Binned cut = bin(line), uncut = bin({});
  EXPECT_GT(cut.counts.parted, 10u);
  EXPECT_EQ(cut.counts.outside, 0u);
  double worst_uncut = 0;
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      if (cut.dem.known(col, row)) {
        ASSERT_NEAR(cut.dem.z(col, row), height(col), 1e-3) << col << ", " << row;
      }
      if (uncut.dem.known(col, row))
        worst_uncut = std::max(worst_uncut, std::abs(double(uncut.dem.z(col, row) - height(col))));
    }
  EXPECT_GT(worst_uncut, 10);
  const Gridded surface = fill_points(cut, find_method(fill_methods(), "spline"));
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      ASSERT_NEAR(surface.filled.z(col, row), height(col), 0.1) << col << ", " << row;
}

TEST(FillMethods, SayWhichHonourBreaklines) {
  const Cliff cliff;
  Dem dem = cliff.samples();
  Dem broken = dem;
  broken.breaks = cliff.lines().breaks();
  for (const FillMethod& method : fill_methods()) {
    const Raster<float> without = method.fill(dem, {}, {}).z, with = method.fill(broken, {}, {}).z;
    EXPECT_EQ(!std::ranges::equal(without.cells(), with.cells()), method.traits.honours_breaklines)
        << method.name;
  }
}

}  // namespace
}  // namespace dem
