#include "dem/deterrace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dem {
namespace {

double rolling(int c, int r) {
  return 100 + 6 * std::sin(c / 30.) * std::cos(r / 24.) + 0.03 * c - 0.02 * r;
}

/// The rolling ground rounded to whole metres.
Dem rounded(int cols, int rows) {
  Dem dem{Raster<float>({cols, rows}), Mask({cols, rows}, 1), {}, {1, 1}};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < cols; ++c) dem.z(c, r) = float(std::round(rolling(c, r)));
  return dem;
}

double rmse(const Raster<float>& z) {
  double sum = 0;
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.cols(); ++c) sum += std::pow(z(c, r) - rolling(c, r), 2);
  return std::sqrt(sum / double(z.size().cells()));
}

TEST(Deterrace, FindsTheGroundUnderWholeMetres) {
  const Dem dem = rounded(150, 120);
  EXPECT_NEAR(rmse(dem.z), 0.29, 0.02);  // 1 / root 12
  EXPECT_LT(rmse(deterrace(dem).z), 0.1);
}

TEST(Deterrace, MovesNoCellByMoreThanTheBound) {
  const Dem dem = rounded(90, 70);
  for (const double bound : {0.5, 0.2, 0.0}) {
    const Deterraced d = deterrace(dem, {.bound_m = bound, .passes = 30});
    for (std::size_t i = 0; i < dem.z.cells().size(); ++i)
      ASSERT_LE(std::abs(double(d.z.cells()[i]) - double(dem.z.cells()[i])), bound);
    EXPECT_LE(d.moved_max_m, bound);
  }
}

TEST(Deterrace, LeavesPlanesAlone) {
  Dem dem = rounded(40, 30);
  for (int r = 0; r < 30; ++r)
    for (int c = 0; c < 40; ++c) dem.z(c, r) = float(3 * c - 2 * r);
  const Raster<float> z = deterrace(dem).z;
  for (int r = 0; r < 30; ++r)
    for (int c = 0; c < 40; ++c) EXPECT_NEAR(z(c, r), dem.z(c, r), 1e-3);
}

TEST(Deterrace, LeavesUnknownCellsOut) {
  Dem dem = rounded(60, 50);
  for (int r = 10; r < 20; ++r)
    for (int c = 15; c < 40; ++c) dem.known(c, r) = 0, dem.z(c, r) = -5000;
  const Raster<float> z = deterrace(dem).z;
  EXPECT_EQ(z(20, 15), -5000);
  for (int c = 15; c < 40; ++c) EXPECT_NEAR(z(c, 9), dem.z(c, 9), 0.5);
}

TEST(Deterrace, DoesNotDependOnThreads) {
  const Dem dem = rounded(100, 90);
  EXPECT_EQ(deterrace(dem, {}, {.threads = 1}).z, deterrace(dem, {}, {.threads = 2}).z);
}

TEST(Deterrace, RefusesANegativeBound) {
  EXPECT_THAT([] { deterrace(rounded(20, 20), {.bound_m = -1}); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("bound = -1")));
}

}  // namespace
}  // namespace dem
