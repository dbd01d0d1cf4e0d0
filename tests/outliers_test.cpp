#include "dem/outliers.h"

#include <gtest/gtest.h>

namespace dem {
namespace {

/// Heights from 0 to 99 m, all known.
Dem ground() {
  Dem dem{Raster<float>({40, 25}), Mask({40, 25}, 1), {}, {}};
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i) dem.z.cells()[i] = float(i % 100);
  return dem;
}

TEST(FindOutliers, NamesAHeightFarFromAllOthers) {
  Dem dem = ground();
  dem.z(7, 3) = 1e6f;
  dem.z(8, 20) = -32768;
  const Outliers found = find_outliers(dem);
  ASSERT_EQ(found.count, 2u);
  EXPECT_EQ(found.first[0].col, 7);
  EXPECT_EQ(found.first[0].row, 3);
  EXPECT_EQ(found.first[0].z, 1e6f);
  EXPECT_EQ(found.first[1].col, 8);
  EXPECT_EQ(found.first[1].row, 20);
}

TEST(FindOutliers, LeavesMountainsBesideTheSeaAlone) {
  Dem dem = ground();
  for (float& z : dem.z.cells()) z = 0;
  dem.z(20, 12) = 8848;
  EXPECT_EQ(find_outliers(dem).count, 0u);
}

TEST(FindOutliers, LooksAtKnownCellsOnly) {
  Dem dem = ground();
  dem.z(7, 3) = 1e6f;
  dem.known(7, 3) = 0;
  EXPECT_EQ(find_outliers(dem).count, 0u);
}

TEST(FindOutliers, CountsAllAndNamesTheFirst) {
  Dem dem = ground();
  for (int col = 0; col < 12; ++col) dem.z(col, 5) = 1e6f;
  const Outliers found = find_outliers(dem, 3);
  EXPECT_EQ(found.count, 12u);
  ASSERT_EQ(found.first.size(), 3u);
  EXPECT_EQ(found.first[2].col, 2);
}

TEST(FindOutliers, WorksOnTenCellsOfWhichOneIsWrong) {
  Dem dem{Raster<float>({10, 1}, 5), Mask({10, 1}, 1), {}, {}};
  dem.z(9, 0) = 1e6f;
  EXPECT_EQ(find_outliers(dem).count, 1u);
}

TEST(FindOutliers, NeedsAKnownCell) {
  const Dem dem{Raster<float>({3, 3}), Mask({3, 3}), {}, {}};
  EXPECT_THROW(find_outliers(dem), std::invalid_argument);
}

}  // namespace
}  // namespace dem
