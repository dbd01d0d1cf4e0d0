#include "dem/contours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dem/mcmd.h"
#include "dem/sample.h"
#include "dem/spline.h"

namespace dem {
namespace {

/// A surface z(col, row) and its contour lines.
template <class Surface>
Dem surface_of(int cols, int rows, const Surface& surface) {
  Dem dem{Raster<float>({cols, rows}), Mask({cols, rows}, 1), {}, {1, 1}};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < cols; ++c) dem.z(c, r) = float(surface(c, r));
  return dem;
}

double hill(int c, int r) {
  return 103 * std::exp(-(std::pow(c - 60, 2) + std::pow(r - 55, 2)) / 1200);
}
double pit(int c, int r) { return 300 - hill(c, r); }
double rolling(int c, int r) {
  return 100 + 40 * std::sin(c / 17.) * std::cos(r / 13.) + 25 * std::sin((c + r) / 29.);
}

double rmse(const Dem& truth, const Raster<float>& z) {
  double sum = 0;
  for (std::size_t i = 0; i < z.cells().size(); ++i)
    sum += std::pow(z.cells()[i] - truth.z.cells()[i], 2);
  return std::sqrt(sum / double(z.cells().size()));
}

TEST(ContourBounds, HoldTheTruthBetweenTwoLevels) {
  const Dem truth = surface_of(120, 110, rolling);
  const ContourBounds b = contour_bounds(sample_contours(truth, 10), {.least_slope = 0});
  int bounded = 0, inside = 0;
  for (std::size_t i = 0; i < truth.z.cells().size(); ++i) {
    if (std::isinf(b.upper.cells()[i]) || b.lower.cells()[i] == b.upper.cells()[i]) continue;
    ++bounded;
    inside += truth.z.cells()[i] >= b.lower.cells()[i] && truth.z.cells()[i] <= b.upper.cells()[i];
  }
  EXPECT_GT(bounded, 4000);
  EXPECT_GT(inside, 0.99 * bounded);  // hills taller than 95 % of a step may stick out
}

TEST(ContourBounds, KnowHillsFromPits) {
  const ContourBounds up = contour_bounds(sample_contours(surface_of(120, 110, hill), 20));
  EXPECT_EQ(up.domes, 1u);
  EXPECT_EQ(up.pits, 1u);  // the ground around, below the lowest line
  EXPECT_GT(up.lower(60, 55), 100);
  EXPECT_LT(up.upper(60, 55), 120);
  const ContourBounds down = contour_bounds(sample_contours(surface_of(120, 110, pit), 20));
  EXPECT_EQ(down.domes, 1u);  // the ground around, above the highest line
  EXPECT_EQ(down.pits, 1u);
  EXPECT_LT(down.upper(60, 55), 200);
  EXPECT_GT(down.lower(60, 55), 180);
}

TEST(ContourBounds, SayNothingOfScatteredCells) {
  const ContourBounds b = contour_bounds(sample_random(surface_of(60, 60, rolling), 300));
  for (int r = 0; r < 60; ++r)
    for (int c = 0; c < 60; ++c)
      if (b.lower(c, r) != b.upper(c, r)) {
        EXPECT_TRUE(std::isinf(b.lower(c, r)) && std::isinf(b.upper(c, r)));
      }
}

TEST(FillContours, KeepsLinesAndStaysStrictlyBetween) {
  const Dem lines = sample_contours(surface_of(120, 110, rolling), 10);
  const Raster<float> z = fill_contours(lines).z;
  const ContourBounds b = contour_bounds(lines, {.least_slope = 0});
  for (int r = 0; r < 110; ++r)
    for (int c = 0; c < 120; ++c) {
      if (lines.known(c, r)) {
        ASSERT_EQ(z(c, r), lines.z(c, r));
      } else if (!std::isinf(b.lower(c, r)) && !std::isinf(b.upper(c, r))) {
        ASSERT_GE(z(c, r), b.lower(c, r));
        ASSERT_LE(z(c, r), b.upper(c, r));
        ASSERT_NE(std::fmod(z(c, r), 10), 0);
      }
    }
}

TEST(FillContours, RoundsTheTopOfAHill) {
  const Dem truth = surface_of(120, 110, hill);
  const Raster<float> z = fill_contours(sample_contours(truth, 20)).z;
  EXPECT_GT(z(60, 55), 101.5);  // the last line is at 100, the top at 103
  EXPECT_LT(z(60, 55), 106);
  EXPECT_GT(z(60, 55), z(57, 55));
  EXPECT_GT(z(57, 55), z(54, 55));
}

TEST(FillContours, IsNearerToTheTruthThanTheSplineAlone) {
  // A plain that falls by one level in a hundred cells, beside a mountain.
  const auto slopes = [](int c, int r) {
    return c < 40 ? 300 - 6 * c + 5 * std::sin(r / 6.) : 60 - (c - 40) / 9. + 2 * std::sin(r / 11.);
  };
  const Dem truth = surface_of(160, 120, slopes), lines = sample_contours(truth, 10);
  EXPECT_LT(rmse(truth, fill_contours(lines).z), 0.9 * rmse(truth, fill_spline(lines).z));
}

TEST(FillContours, OfNoContourLinesIsTheSpline) {
  // Whole metres at every second cell: few levels, and gaps between two of them, but no lines.
  Dem rounded = surface_of(120, 110, rolling);
  for (float& z : rounded.z.cells()) z = std::round(z);
  for (const Dem& dem : {sample_random(rounded, 6600), sample_random(rounded, 600),
                         sample_voids(rounded, {.remove = 2000})}) {
    EXPECT_FALSE(contour_bounds(dem).lines);
    const Raster<float> got = fill_contours(dem).z, want = fill_spline(dem).z;
    EXPECT_TRUE(std::ranges::equal(got.cells(), want.cells()));
  }
  EXPECT_TRUE(contour_bounds(sample_contours(rounded, 10)).lines);
}

/// How much likelier a cell between lines lies within a twentieth of a level than elsewhere.
double peak_ratio(const Dem& lines, const Raster<float>& z, double interval) {
  double near = 0, all = 0;
  for (std::size_t i = 0; i < z.cells().size(); ++i) {
    if (lines.known.cells()[i]) continue;
    const double steps = double(z.cells()[i]) / interval;
    near += std::abs(steps - std::round(steps)) < 0.05;
    ++all;
  }
  return near / (0.1 * all);
}

TEST(FillMcmd, WithTwoSidedContoursMakesNoTerraces) {
  const Dem truth = surface_of(160, 150, rolling), lines = sample_contours(truth, 20);
  const Raster<float> one = fill_mcmd(lines), two = fill_mcmd(lines, {.two_sided = true});
  EXPECT_GT(peak_ratio(lines, one, 20), 3);
  EXPECT_LT(peak_ratio(lines, two, 20), 1.3);
  EXPECT_LT(rmse(truth, two), 0.8 * rmse(truth, one));
  for (std::size_t i = 0; i < two.cells().size(); ++i)
    if (lines.known.cells()[i]) {
      ASSERT_EQ(two.cells()[i], lines.z.cells()[i]);
    }
  const Raster<float> threaded = fill_mcmd(lines, {.two_sided = true}, {3, {}});
  EXPECT_TRUE(std::ranges::equal(two.cells(), threaded.cells()));
}

TEST(FillMcmd, WithTwoSidedContoursIsExactBetweenStraightLines) {
  // A plane: each cell off a line finds the two next lines, and lies between them as it should.
  const Dem lines = sample_contours(surface_of(90, 40, [](int c, int) { return 100 + 2 * c; }), 10);
  const Raster<float> z = fill_mcmd(lines, {.two_sided = true});
  for (int c = 10; c < 80; ++c) EXPECT_NEAR(z(c, 20), 100 + 2 * c, 0.5) << c;
}

}  // namespace
}  // namespace dem
