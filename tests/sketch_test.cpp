#include "dem/sketch.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace dem {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Bad = std::invalid_argument;

const Spacing cell_30{30, 30};

// ---- Sketches

TEST(ReadSketch, TakesGreysAsHeightsAndWhiteAsUnknown) {
  Raster<float> drawing({3, 1}, 1);
  drawing(0, 0) = 0, drawing(1, 0) = 0.5F;
  const Dem dem = read_sketch(drawing, cell_30, {.low_m = 100, .high_m = 300});
  EXPECT_THAT(dem.known.cells(), ::testing::ElementsAre(1, 1, 0));
  EXPECT_EQ(dem.z(0, 0), 100);
  EXPECT_EQ(dem.z(1, 0), 200);
}

TEST(ReadSketch, SaltMakesItsShareOfTheWhiteKnown) {
  Raster<float> drawing({400, 300}, 1);
  for (int col = 0; col < 400; ++col) drawing(col, 100) = 0.25F;
  const Dem dem = read_sketch(drawing, cell_30, {.salt = 0.01});
  const double white = 400 * 299;
  EXPECT_NEAR(double(count(dem.known)) - 400, 0.01 * white, 4 * std::sqrt(0.01 * white));
  float low = 1e9F, high = -1e9F;
  for (int row = 0; row < 300; ++row)
    for (int col = 0; col < 400; ++col) {
      ASSERT_TRUE(row != 100 || dem.z(col, row) == 63.75F);
      if (row != 100 && dem.known(col, row)) low = std::min(low, dem.z(col, row));
      if (row != 100 && dem.known(col, row)) high = std::max(high, dem.z(col, row));
    }
  EXPECT_LT(low, 5);
  EXPECT_GT(high, 250);
}

TEST(GenerateSketch, KeepsWhatWasDrawn) {
  Raster<float> drawing({65, 65}, 1);
  for (int i = 10; i < 50; ++i) drawing(i, i / 2) = 0.5F;
  const SketchOptions options{.mcmd = {.I = -1.1, .I_bu = -20, .rs = 1}};
  const Canvas canvas{{65, 65}, cell_30, {}};
  const Raster<float> z = generate_sketch(canvas, drawing, options);
  for (int i = 10; i < 50; ++i) EXPECT_EQ(z(i, i / 2), 127.5F);
  for (float h : z.cells()) EXPECT_TRUE(std::isfinite(h));
}

TEST(ReadSketch, RefusesDrawingsThatSayNothingOrEverything) {
  const auto refusal = [](Size size, float grey) {
    return [=] { read_sketch(Raster<float>(size, grey), cell_30); };
  };
  EXPECT_THAT(refusal({9, 9}, 1), ThrowsMessage<Bad>(HasSubstr("all white")));
  EXPECT_THAT(refusal({9, 9}, 0), ThrowsMessage<Bad>(HasSubstr("no white")));
  EXPECT_THAT(refusal({0, 0}, 0), ThrowsMessage<Bad>(HasSubstr("size = 0 x 0")));
  EXPECT_NO_THROW(read_sketch(Raster<float>({99, 99}, 1), cell_30, {.salt = 0.1}));
}

// ---- L-systems

/// Known cells as rows of text.
std::vector<std::string> picture(const Dem& dem) {
  std::vector<std::string> rows;
  for (int row = 0; row < dem.z.rows(); ++row) {
    rows.emplace_back();
    for (int col = 0; col < dem.z.cols(); ++col) rows.back() += dem.known(col, row) ? '#' : '.';
  }
  return rows;
}

TEST(LSystem, DrawsWhatItsSymbolsSay) {
  // A stem of two lines, branches to the right and, mirrored, to the left, half as long.
  const LSystem tree{"FX", {{'X', "F[@.5-FF]![@.5-F]"}}, 0.25, 0.25};
  const Dem dem =
      draw_lsystem({7, 9}, {1, 1}, tree, {.rewrites = 1, .low_m = 0, .high_m = 100, .margin = 0});
  // The stem is 2 high and what it draws 1.5 wide: 8 cells for 2 lines.
  EXPECT_EQ(picture(dem),
            (std::vector<std::string>{"#######", "..#....", "..#....", "..#....", "..#....",
                                      "..#....", "..#....", "..#....", "..#...."}));
  EXPECT_EQ(dem.z(2, 4), 100);                                // full length
  EXPECT_FLOAT_EQ(dem.z(5, 0), float(100 * std::sqrt(0.5)));  // half as long
}

TEST(LSystem, ThePapersGrowsThreefoldWithEachRewriting) {
  // X makes 2 lines and 3 X: after n rewritings there are 3^n - 1 lines.
  std::size_t before = 0;
  for (int rewrites = 1; rewrites <= 8; ++rewrites) {
    const Dem dem = draw_lsystem({257, 257}, {30, 30}, {}, {.rewrites = rewrites});
    EXPECT_GT(count(dem.known), rewrites > 1 ? before / 2 : 0) << rewrites;
    before = count(dem.known);
  }
  EXPECT_GT(before, 1500U);
}

TEST(LSystem, FitsIntoItsMargin) {
  const Dem dem = draw_lsystem({200, 100}, cell_30, {}, {.margin = 0.2});
  int top = 100, bottom = -1, left = 200, right = -1;
  for (int row = 0; row < 100; ++row)
    for (int col = 0; col < 200; ++col)
      if (dem.known(col, row)) {
        top = std::min(top, row), bottom = std::max(bottom, row);
        left = std::min(left, col), right = std::max(right, col);
      }
  EXPECT_NEAR(top, 0.2 * 99, 2);  // the path is higher than wide; its finest ends are left out
  EXPECT_NEAR(bottom, 0.8 * 99, 2);
  EXPECT_NEAR((left + right) / 2.0, 99.5, 1);
}

TEST(LSystem, RefusesWhatCannotBe) {
  const auto refusal = [](LSystem system, LSystemOptions options = {}) {
    return [=] { draw_lsystem({65, 65}, cell_30, system, options); };
  };
  EXPECT_THAT(refusal({}, {.rewrites = 0}), ThrowsMessage<Bad>(HasSubstr("draws nothing")));
  EXPECT_THAT(refusal({"F]F", {}}), ThrowsMessage<Bad>(HasSubstr("do not match")));
  EXPECT_THAT(refusal({"F[F", {}}), ThrowsMessage<Bad>(HasSubstr("do not match")));
  EXPECT_THAT(refusal({"F@xF", {}}), ThrowsMessage<Bad>(HasSubstr("needs a number above 0")));
  EXPECT_THAT(
      [] {
        draw_lsystem({1, 1}, cell_30);
      },
      ThrowsMessage<Bad>(HasSubstr("must be at least 2 x 2")));
}

}  // namespace
}  // namespace dem
