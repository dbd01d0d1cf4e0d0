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
    const HillshadeOptions averted{.azimuth_deg = double((azimuth + 180) % 360)};
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
  const auto dark = shaded_relief(plane({9, 9}, 5, 0), {30, 30}, {.light = {.azimuth_deg = 90}});
  EXPECT_LT(dark(4, 4)[0], slope(4, 4)[0]);
}

TEST(Hillshade, DrawsUnknownCellsWhite) {
  auto z = plane({6, 6}, 5, 2);
  Mask known(z.size(), 1);
  known(3, 3) = 0;
  z(3, 3) = std::numeric_limits<float>::quiet_NaN();
  const auto grey = hillshade(z, {30, 30}, {}, known);
  EXPECT_EQ(grey(3, 3), 255);
  EXPECT_EQ(grey(2, 3), grey(0, 0));
}

TEST(Hillshade, FourLightsKeepDetailInTheShade) {
  // Slopes of 60 and 70 degrees that fall away from a light at 45 degrees are black in it.
  const auto averted = [](double rise, bool multidirectional) {
    return hillshade(plane({3, 3}, -rise, -rise), {10, 10}, {.multidirectional = multidirectional})(
        1, 1);
  };
  EXPECT_EQ(averted(12, false), 0);
  EXPECT_EQ(averted(19, false), 0);
  EXPECT_GT(averted(12, true), 20);
  EXPECT_GT(averted(19, true), 20);
}

TEST(Hillshade, FourLightsAreWeightedByTheirAngleToTheFall) {
  // Ground that falls to the east at 1 in 2, lights at 225, 270, 315 and 360 degrees, 30 high.
  const auto grey = hillshade(plane({4, 4}, -10, 0), {20, 20},
                              {.altitude_deg = 30, .multidirectional = true})(1, 1);
  double sum = 0;
  for (const double azimuth : {225.0, 270.0, 315.0, 360.0}) {
    const double a = azimuth * std::numbers::pi / 180;
    const double slant =
        (0.5 * std::sin(a) * std::cos(std::numbers::pi / 6) + 0.5) / std::sqrt(1.25);
    sum += std::pow(std::cos(a), 2) * std::max(0.0, slant);  // the fall is at 90 degrees
  }
  EXPECT_NEAR(grey, 255 * sum / 2, 0.5);
  for (const double altitude : {10.0, 45.0, 90.0})
    EXPECT_EQ(
        hillshade(plane({2, 2}, 0, 0), {}, {.altitude_deg = altitude}),
        hillshade(plane({2, 2}, 0, 0), {}, {.altitude_deg = altitude, .multidirectional = true}));
}

/// Relative luminance of a colour.
double luminance(const Colour& c) {
  const auto linear = [](double v) { return std::pow(v / 255, 2.2); };
  return 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
}

TEST(Palette, HigherIsLighterInEach) {
  for (std::size_t p = 0; p < palettes().size(); ++p)
    for (int i = 0; i < 100; ++i)
      EXPECT_LT(luminance(palette_colour(Palette(p), i / 100.0)),
                luminance(palette_colour(Palette(p), (i + 1) / 100.0)))
          << palettes()[p].name << " " << i;
}

TEST(Palette, EndsAreKeptBeyondThem) {
  for (std::size_t p = 0; p < palettes().size(); ++p) {
    EXPECT_EQ(palette_colour(Palette(p), -3), palette_colour(Palette(p), 0));
    EXPECT_EQ(palette_colour(Palette(p), 3), palette_colour(Palette(p), 1));
  }
}

TEST(ColourScale, DeeperWaterIsDarkerAndLandStartsAtTheSea) {
  const ColourScale dry{Palette::atlas, -100, 300, false}, sea{Palette::atlas, -100, 300, true};
  EXPECT_EQ(dry(-100), palette_colour(Palette::atlas, 0));
  EXPECT_EQ(dry(100), palette_colour(Palette::atlas, 0.5));
  EXPECT_EQ(sea(150), palette_colour(Palette::atlas, 0.5));
  EXPECT_LT(luminance(sea(-100)), luminance(sea(-50)));
  EXPECT_LT(luminance(sea(-50)), luminance(sea(0)));
  EXPECT_GT(sea(0)[2], sea(0)[0]);  // blue
  EXPECT_EQ((ColourScale{Palette::atlas, 7, 7, false}(7)), palette_colour(Palette::atlas, 0));
}

TEST(ShadedRelief, LevelGroundHasThePaletteColour) {
  auto z = plane({40, 3}, 0, 0);
  for (int row = 0; row < 3; ++row)
    for (int col = 20; col < 40; ++col) z(col, row) = 100;
  for (std::size_t p = 0; p < palettes().size(); ++p) {
    const auto picture = shaded_relief(z, {30, 30}, {.palette = Palette(p)});
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(picture(2, 1)[c], palette_colour(Palette(p), 0)[c], 0.5);
      EXPECT_NEAR(picture(37, 1)[c], palette_colour(Palette(p), 1)[c], 0.5);
    }
  }
}

TEST(ShadedRelief, ThreadsChangeNothing) {
  Raster<float> z({97, 300});
  for (int row = 0; row < 300; ++row)
    for (int col = 0; col < 97; ++col) z(col, row) = float(50 * std::sin(col / 9.0) + row % 17);
  const ReliefOptions options{.light = {.multidirectional = true}};
  EXPECT_EQ(shaded_relief(z, {30, 30}, options, {}, {.threads = 1, .progress = {}}),
            shaded_relief(z, {30, 30}, options, {}, {.threads = 4, .progress = {}}));
}

TEST(ShadedRelief, RefusesAPaletteThereIsNot) {
  ReliefOptions options;
  EXPECT_THROW(apply({{"palette", "rainbow"}}, fields(options)), std::invalid_argument);
  EXPECT_THROW(shaded_relief(plane({3, 3}, 0, 0), {}, {.palette = Palette(99)}),
               std::invalid_argument);
}

TEST(ShadedRelief, RefusesAMaskOfAnotherSize) {
  EXPECT_THROW(shaded_relief(plane({3, 3}, 0, 0), {}, {}, Mask({3, 2})), std::invalid_argument);
}

}  // namespace
}  // namespace dem
