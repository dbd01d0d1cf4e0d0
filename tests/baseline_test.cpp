#include "dem/baseline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

/// A few known cells (one in `sparse`) with heights of few values, so that ties are common.
Dem scattered(Size size, std::uint64_t sparse, std::uint64_t seed, Spacing spacing = {}) {
  Dem dem{Raster<float>(size), Mask(size), {}, spacing};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      if (below(random_bits(seed, 0, col, row), sparse) == 0) {
        dem.known(col, row) = 1;
        dem.z(col, row) = float(below(random_bits(seed, 1, col, row), 1000));
      } else {
        dem.z(col, row) = -9999;
      }
  dem.known(size.cols / 2, size.rows / 2) = 1;
  dem.z(size.cols / 2, size.rows / 2) = 500;
  return dem;
}

/// Every known cell tried for every cell. dx and dy whole: distances are exact.
Raster<float> by_brute_force(const Dem& dem) {
  Raster<float> z(dem.size());
  for (int row = 0; row < z.rows(); ++row)
    for (int col = 0; col < z.cols(); ++col) {
      double nearest = 1e300;
      for (int r = 0; r < z.rows(); ++r)
        for (int c = 0; c < z.cols(); ++c) {
          if (!dem.known(c, r)) continue;
          const double x = dem.spacing.dx_m * (c - col), y = dem.spacing.dy_m * (r - row);
          const double away = x * x + y * y;
          if (away < nearest || (away == nearest && dem.z(c, r) < z(col, row))) {
            nearest = away;
            z(col, row) = dem.z(c, r);
          }
        }
    }
  return z;
}

TEST(FillNearest, EqualsBruteForceWithTies) {
  for (const Size size : {Size{1, 1}, {1, 23}, {23, 1}, {2, 2}, {37, 29}, {64, 65}})
    for (const std::uint64_t sparse : {2, 5, 20, 100, 1000})
      for (const Spacing spacing : {Spacing{1, 1}, {3, 4}, {90, 30}, {64, 89}}) {
        const Dem dem = scattered(size, sparse, sparse + std::uint64_t(size.cols), spacing);
        ASSERT_EQ(fill_nearest(dem), by_brute_force(dem))
            << size.cols << " x " << size.rows << ", one in " << sparse << ", " << spacing.dx_m;
      }
}

TEST(FillNearest, ChoosesTheSmallerOfEquallyNearOnesInAnyDirection) {
  // The middle of a ring of twelve cells at the distance 5: (5,0), (3,4), (4,3) and so on.
  const std::pair<int, int> ring[] = {{5, 0},  {4, 3},   {3, 4},   {0, 5},  {-3, 4}, {-4, 3},
                                      {-5, 0}, {-4, -3}, {-3, -4}, {0, -5}, {3, -4}, {4, -3}};
  for (const auto& [low_col, low_row] : ring) {
    Dem dem{Raster<float>({11, 11}), Mask({11, 11}), {}, {30, 30}};
    for (const auto& [col, row] : ring) {
      dem.known(5 + col, 5 + row) = 1;
      dem.z(5 + col, 5 + row) = 7;
    }
    dem.z(5 + low_col, 5 + low_row) = 3;
    EXPECT_EQ(fill_nearest(dem)(5, 5), 3) << low_col << " " << low_row;
  }
}

TEST(FillNearest, MirroredInputGivesMirroredOutput) {
  const Dem dem = scattered({83, 61}, 40, 9, {66.8, 92.6});
  Dem mirrored = dem;
  for (int row = 0; row < 61; ++row) {
    std::ranges::reverse(mirrored.z.row(row));
    std::ranges::reverse(mirrored.known.row(row));
  }
  const auto z = fill_nearest(dem);
  auto back = fill_nearest(mirrored);
  for (int row = 0; row < 61; ++row) std::ranges::reverse(back.row(row));
  EXPECT_EQ(z, back);
}

TEST(FillNearest, MeasuresInMetres) {
  Dem dem{Raster<float>({3, 3}), Mask({3, 3}), {}, {50, 90}};
  dem.known(0, 1) = dem.known(1, 0) = 1;
  dem.z(0, 1) = 8;  // 50 m west of the middle
  dem.z(1, 0) = 2;  // 90 m north of it
  EXPECT_EQ(fill_nearest(dem)(1, 1), 8);
  dem.spacing = {90, 50};
  EXPECT_EQ(fill_nearest(dem)(1, 1), 2);
}

TEST(FillNearest, ThreadsDoNotChangeIt) {
  const Dem dem = scattered({700, 400}, 50, 4, {66.8, 92.6});
  EXPECT_EQ(fill_nearest(dem, {}, {.threads = 1}), fill_nearest(dem, {}, {.threads = 2}));
}

TEST(FillNearest, OneKnownCellFillsAll) {
  const Dem dem = scattered({300, 20}, 1000000000, 4);
  EXPECT_EQ(fill_nearest(dem), Raster<float>(dem.size(), 500));
}

TEST(FillNearest, StopsWhenAsked) {
  const Dem dem = scattered({30, 30}, 9, 4);
  const dem::Run run{1, [](double part, std::string_view) { return part < 0.3; }};
  EXPECT_THROW(fill_nearest(dem, {}, run), Cancelled);
}

TEST(FillNearest, RefusesNoKnownCellAndNoSpacing) {
  Dem dem = scattered({3, 3}, 9, 4, {0, 30});
  EXPECT_THROW(fill_nearest(dem), std::invalid_argument);
  dem.spacing = {30, 30};
  dem.known = Mask(dem.size());
  EXPECT_THROW(fill_nearest(dem), std::invalid_argument);
}

}  // namespace
}  // namespace dem
