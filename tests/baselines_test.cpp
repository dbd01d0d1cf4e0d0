#include "dem/io/methods.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>
#include <stdexcept>

namespace dem {
namespace {

/// Hills with most cells missing, among them the whole rim.
Dem holed(Size size) {
  Dem dem{Raster<float>(size), Mask(size), {}, {}};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      if ((col * 7 + row * 13) % 17 == 3 || (col == size.cols / 2 && row == size.rows / 2)) {
        dem.known(col, row) = 1;
        dem.z(col, row) = 1000 + 300 * std::sin(0.1f * float(col)) * std::cos(0.07f * float(row));
      }
  return dem;
}

class EachBaseline : public ::testing::TestWithParam<FillMethod> {};

TEST_P(EachBaseline, KeepsKnownCellsBitForBitAndFillsTheRest) {
  for (const Size size : {Size{1, 1}, Size{1, 40}, Size{40, 1}, Size{2, 2}, Size{97, 64}}) {
    const Dem dem = holed(size);
    const Raster<float> z = GetParam().fill(dem, {}, {}).z;
    ASSERT_EQ(z.size(), size);
    for (std::size_t i = 0; i < z.cells().size(); ++i) {
      ASSERT_TRUE(std::isfinite(z.cells()[i]));
      if (dem.known.cells()[i]) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(z.cells()[i]),
                  std::bit_cast<std::uint32_t>(dem.z.cells()[i]));
      }
      // No method here leaves the range of the data by more than rounding.
      ASSERT_GT(z.cells()[i], 699.9f);
      ASSERT_LT(z.cells()[i], 1300.1f);
    }
  }
}

TEST_P(EachBaseline, ConstantsStayConstant) {
  Dem dem = holed({60, 41});
  for (float& z : dem.z.cells()) z = 1234.5f;
  const Raster<float> filled = GetParam().fill(dem, {}, {}).z;
  // Some tens of float32 roundings, each of 6e-5 m at this height.
  for (float z : filled.cells()) ASSERT_NEAR(z, 1234.5f, 5e-3);
}

TEST_P(EachBaseline, OneKnownCellSuffices) {
  Dem dem{Raster<float>({33, 20}), Mask({33, 20}), {}, {}};
  dem.known(30, 1) = 1;
  dem.z(30, 1) = 77;
  const Raster<float> filled = GetParam().fill(dem, {}, {}).z;
  for (float z : filled.cells()) ASSERT_NEAR(z, 77, 1e-3);
}

TEST_P(EachBaseline, NoKnownCellIsRefused) {
  const Dem dem{Raster<float>({5, 5}), Mask({5, 5}), {}, {}};
  EXPECT_THROW(GetParam().fill(dem, {}, {}), std::invalid_argument);
}

TEST_P(EachBaseline, StopsWhenAsked) {
  dem::Run run;
  run.progress = [](double, std::string_view) { return false; };
  EXPECT_THROW(GetParam().fill(holed({60, 41}), {}, run), Cancelled);
}

TEST_P(EachBaseline, ThreadsDoNotChangeTheResult) {
  const Dem dem = holed({97, 64});
  EXPECT_EQ(GetParam().fill(dem, {}, {.threads = 1, .progress = {}}).z,
            GetParam().fill(dem, {}, {.threads = 2, .progress = {}}).z);
}

INSTANTIATE_TEST_SUITE_P(Methods, EachBaseline, ::testing::ValuesIn(baseline_methods()),
                         [](const auto& method) { return method.param.name; });

TEST(Idw, SmoothingPassesSmoothFilledCellsOnly) {
  const Dem dem = holed({97, 64});
  const FillMethod& idw = *find_method(baseline_methods(), "idw").method;
  const Raster<float> plain = idw.fill(dem, {}, {}).z;
  const Raster<float> smooth = idw.fill(dem, {{"smoothing_passes", "3"}}, {}).z;
  EXPECT_NE(plain, smooth);
  for (std::size_t i = 0; i < plain.cells().size(); ++i)
    if (dem.known.cells()[i]) {
      ASSERT_EQ(plain.cells()[i], smooth.cells()[i]);
    }
  EXPECT_THROW(idw.fill(dem, {{"smoothing_passes", "-1"}}, {}), std::invalid_argument);
}

TEST(Idw, IsTheWeightedMeanAlongALine) {
  // Two known cells, 10 and 40, at distances 1 and 2: (10 / 1 + 40 / 2) / (1 / 1 + 1 / 2) = 20.
  Dem dem{Raster<float>({4, 1}), Mask({4, 1}), {}, {}};
  dem.known(0, 0) = dem.known(3, 0) = 1;
  dem.z(0, 0) = 10;
  dem.z(3, 0) = 40;
  EXPECT_NEAR(find_method(baseline_methods(), "idw").method->fill(dem, {}, {}).z(1, 0), 20, 1e-4);
}

TEST(AllFillMethods, HaveDifferentNames) {
  std::set<std::string> names;
  for (const FillMethod& m : all_fill_methods()) EXPECT_TRUE(names.insert(m.name).second) << m.name;
  EXPECT_TRUE(names.contains("idw") && names.contains("pushpull"));
  EXPECT_EQ(names.size(), fill_methods().size() + baseline_methods().size());
}

}  // namespace
}  // namespace dem
