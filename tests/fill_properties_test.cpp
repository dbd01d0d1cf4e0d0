// What every fill method of the table must do.

#include <gmock/gmock.h>

#include <cmath>

#include "dem/methods.h"
#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

class FillProperties : public ::testing::TestWithParam<FillMethod> {
 protected:
  /// The method with every noise off: what it makes of the data alone.
  static Settings quiet() {
    Settings settings;
    for (const auto& field : GetParam().fields)
      if (field.name == "rs_bu" || field.name == "rs") settings.emplace_back(field.name, "0");
    return settings;
  }

  static Raster<float> fill(const Dem& dem, const dem::Run& run = {}) {
    return GetParam().fill(dem, quiet(), run).z;
  }

  static Dem terrain(Size size, double kept, std::uint64_t seed) {
    Dem dem{Raster<float>(size), Mask(size), {}, {30, 30}};
    for (int row = 0; row < size.rows; ++row)
      for (int col = 0; col < size.cols; ++col) {
        dem.z(col, row) = float(200 * std::sin(col * 0.05) * std::cos(row * 0.08) - 50 +
                                3 * signed_uniform(random_bits(seed, 1, col, row)));
        dem.known(col, row) = signed_uniform(random_bits(seed, 2, col, row)) < 2 * kept - 1;
      }
    for (int col : {0, size.cols - 1})  // plain MD needs its corners
      for (int row : {0, size.rows - 1}) dem.known(col, row) = 1;
    return dem;
  }
};

const std::vector<Size> sizes{{1, 1}, {2, 2},   {1, 50},   {50, 1},  {3, 2},
                              {9, 9}, {33, 65}, {100, 37}, {64, 64}, {201, 133}};

TEST_P(FillProperties, LeaveNoHoleAndKeepKnownCellsBitForBit) {
  for (Size size : sizes)
    for (double kept : {0.02, 0.3, 0.97}) {
      Dem dem = terrain(size, kept, 3);
      for (std::size_t i = 0; i < size.cells(); ++i)  // what is unknown must not be read
        if (!dem.known.cells()[i]) dem.z.cells()[i] = std::nanf("");
      const auto z = fill(dem);
      ASSERT_EQ(z.size(), size);
      for (std::size_t i = 0; i < size.cells(); ++i) {
        ASSERT_TRUE(std::isfinite(z.cells()[i])) << size.cols << " x " << size.rows;
        if (dem.known.cells()[i]) {
          ASSERT_EQ(z.cells()[i], dem.z.cells()[i]);
        }
      }
    }
}

TEST_P(FillProperties, AConstantStaysTheSameConstant) {
  for (Size size : sizes)
    for (float constant : {0.f, -413.37f, 8848.86f}) {
      Dem dem = terrain(size, 0.1, 4);
      for (float& z : dem.z.cells()) z = constant;
      const auto filled = fill(dem);
      for (float z : filled.cells()) ASSERT_EQ(z, constant) << size.cols << " x " << size.rows;
    }
}

TEST_P(FillProperties, AddingAConstantToTheDataAddsItToTheSurface) {
  const Dem low = terrain({100, 67}, 0.1, 5);
  Dem high = low;
  for (float& z : high.z.cells()) z += 2000;
  const auto a = fill(low), b = fill(high);
  for (std::size_t i = 0; i < a.cells().size(); ++i)
    ASSERT_NEAR(a.cells()[i] + 2000, b.cells()[i], 0.01);  // float32 at 2000 m: 1.2e-4 m a rounding
}

TEST_P(FillProperties, MirroredDataGiveTheMirroredSurface) {
  const Size size{65, 33};
  const Dem dem = terrain(size, 0.1, 6);
  Dem mirrored = dem;
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      mirrored.z(col, row) = dem.z(size.cols - 1 - col, row);
      mirrored.known(col, row) = dem.known(size.cols - 1 - col, row);
    }
  const auto a = fill(dem), b = fill(mirrored);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      ASSERT_NEAR(a(col, row), b(size.cols - 1 - col, row), 0.01);
}

TEST_P(FillProperties, AnyNumberOfThreadsGivesTheSameBits) {
  const Dem dem = terrain({333, 401}, 0.05, 7);
  const auto one = GetParam().fill(dem, {}, {1, {}}).z;
  for (int threads : {2, 3, 0})
    EXPECT_EQ(GetParam().fill(dem, {}, {threads, {}}).z, one) << threads;
}

TEST_P(FillProperties, TheSameCallGivesTheSameBits) {
  const Dem dem = terrain({70, 90}, 0.1, 8);
  EXPECT_EQ(GetParam().fill(dem, {}, {}).z, GetParam().fill(dem, {}, {}).z);
}

TEST_P(FillProperties, AWholeDemComesBackAsItIs) {
  const Dem dem = terrain({40, 30}, 1.1, 9);
  EXPECT_EQ(fill(dem), dem.z);
}

TEST_P(FillProperties, OneKnownCellIsEnough) {
  for (Size size : sizes) {
    Dem dem{Raster<float>(size), Mask(size), {}, {}};
    dem.z(0, 0) = 77;
    dem.known(0, 0) = 1;
    const auto filled = fill(dem);
    for (float z : filled.cells()) ASSERT_TRUE(std::isfinite(z));
  }
}

TEST_P(FillProperties, ProgressRisesAndAStopStopsIt) {
  const Dem dem = terrain({300, 300}, 0.1, 10);
  double part = 0;
  int calls = 0;
  GetParam().fill(dem, {}, {1, [&](double now, std::string_view what) {
                              EXPECT_GE(now, part);
                              EXPECT_LE(now, 1);
                              EXPECT_FALSE(what.empty());
                              part = now, ++calls;
                              return true;
                            }});
  EXPECT_GT(calls, 0);
  EXPECT_THROW(GetParam().fill(dem, {}, {1, [](double, std::string_view) { return false; }}),
               Cancelled);
}

TEST_P(FillProperties, DescribeTheirFields) {
  EXPECT_FALSE(GetParam().summary.empty());
  for (const auto& field : GetParam().fields) {
    EXPECT_FALSE(field.doc.empty()) << field.name;
    EXPECT_NO_THROW(
        GetParam().fill(terrain({8, 8}, 0.5, 1), {{field.name, field.default_text}}, {}));
    EXPECT_THROW(GetParam().fill(terrain({8, 8}, 0.5, 1), {{field.name, "nonsense"}}, {}),
                 std::invalid_argument);
  }
  for (const auto& preset : GetParam().presets)
    EXPECT_NO_THROW(GetParam().fill(terrain({8, 8}, 0.5, 1), preset.settings, {})) << preset.name;
}

INSTANTIATE_TEST_SUITE_P(Methods, FillProperties, ::testing::ValuesIn(fill_methods()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace dem
