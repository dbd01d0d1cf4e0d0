#include "dem/draw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace dem {
namespace {

Raster<float> plane(Size size, double east, double south) {
  Raster<float> z(size);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) z(col, row) = float(east * col + south * row);
  return z;
}

TEST(Hillshade, FlatGroundIsTheSineOfTheAltitude) {
  for (const double altitude : {0.0, 20.0, 45.0, 90.0}) {
    const auto grey = hillshade(plane({5, 4}, 0, 0), {30, 30}, {.altitude_deg = altitude});
    const auto expected = std::lround(255 * std::sin(altitude * std::numbers::pi / 180));
    for (const auto g : grey.cells()) EXPECT_EQ(g, expected);
  }
}

TEST(Hillshade, GroundThatFacesTheLightIsBright) {
  // A slope of 45 degrees that falls towards the light at 45 degrees faces it: 255. Every azimuth
  // of the compass: the height grows away from the light.
  for (int azimuth = 0; azimuth < 360; azimuth += 45) {
    const double a = azimuth * std::numbers::pi / 180;
    const auto z = plane({6, 6}, -30 * std::sin(a), 30 * std::cos(a));
    const HillshadeOptions facing{.azimuth_deg = double(azimuth)};
    const HillshadeOptions averted{.azimuth_deg = double(azimuth + 180)};
    EXPECT_EQ(hillshade(z, {30, 30}, facing), Raster<std::uint8_t>(z.size(), 255)) << azimuth;
    EXPECT_EQ(hillshade(z, {30, 30}, averted), Raster<std::uint8_t>(z.size(), 0)) << azimuth;
  }
}

TEST(Hillshade, IsLitFromTheNorthWestByDefault) {
  const auto falls_north_west = hillshade(plane({3, 3}, 10, 10), {30, 30});
  const auto falls_south_east = hillshade(plane({3, 3}, -10, -10), {30, 30});
  EXPECT_GT(falls_north_west(1, 1), 200);
  EXPECT_LT(falls_south_east(1, 1), 150);
}

TEST(Hillshade, IsTheSameUpToTheRim) {
  const auto grey = hillshade(plane({7, 5}, 4, -9), {30, 20});
  for (const auto g : grey.cells()) EXPECT_EQ(g, grey(3, 2));
}

TEST(Hillshade, ExaggerationIsSteeperGround) {
  EXPECT_EQ(hillshade(plane({4, 4}, 3, 1), {30, 30}, {.exaggeration = 4}),
            hillshade(plane({4, 4}, 12, 4), {30, 30}));
}

TEST(Hillshade, DrawsASingleRowColumnAndCell) {
  EXPECT_EQ(hillshade(plane({1, 1}, 0, 0), {})(0, 0), 180);  // 255 sin 45 = 180.3
  EXPECT_EQ(hillshade(plane({9, 1}, -1, 0), {}, {.azimuth_deg = 90})(8, 0), 255);
  EXPECT_EQ(hillshade(plane({1, 9}, 0, -1), {}, {.azimuth_deg = 180})(0, 0), 255);
}

TEST(Hillshade, RefusesWhatIsNoLight) {
  const auto z = plane({3, 3}, 0, 0);
  EXPECT_THROW(hillshade(z, {}, {.altitude_deg = 91}), std::invalid_argument);
  EXPECT_THROW(hillshade(z, {}, {.altitude_deg = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(hillshade(z, {}, {.azimuth_deg = INFINITY}), std::invalid_argument);
  EXPECT_THROW(hillshade(z, {}, {.exaggeration = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(hillshade(z, {0, 1}), std::invalid_argument);
  EXPECT_THROW(hillshade({}, {}), std::invalid_argument);
}

TEST(ShadedRelief, DrawsUnknownCellsWhiteAndTheirHeightsNowhere) {
  auto z = plane({6, 6}, 5, 2);
  Mask known(z.size(), 1);
  known(3, 3) = 0;
  z(3, 3) = -32768;
  const auto low = shaded_relief(z, {30, 30}, {}, known);
  z(3, 3) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(low, shaded_relief(z, {30, 30}, {}, known));
  EXPECT_EQ(low(3, 3), (Rgb{255, 255, 255}));
  EXPECT_NE(low(2, 3), (Rgb{255, 255, 255}));
}

TEST(ShadedRelief, ColourFollowsHeightAndLight) {
  const auto even = shaded_relief(plane({9, 9}, 0, 0), {30, 30});
  for (const auto& c : even.cells()) EXPECT_EQ(c, even(0, 0));
  // On a slope the light is the same everywhere: only the colour changes with the height.
  const auto slope = shaded_relief(plane({9, 9}, 5, 0), {30, 30});
  EXPECT_EQ(slope(4, 0), slope(4, 8));
  EXPECT_NE(slope(0, 4), slope(8, 4));
  // The same heights, lit from the other side, are darker.
  const auto dark = shaded_relief(plane({9, 9}, 5, 0), {30, 30}, {.azimuth_deg = 90});
  EXPECT_LT(dark(4, 4)[0], slope(4, 4)[0]);
}

TEST(ShadedRelief, RefusesAMaskOfAnotherSize) {
  EXPECT_THROW(shaded_relief(plane({3, 3}, 0, 0), {}, {}, Mask({3, 2})), std::invalid_argument);
}

}  // namespace
}  // namespace dem
