#include "dem/faults.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace dem {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Canvas canvas(int cols, int rows, double cell_m) { return {{cols, rows}, {cell_m, cell_m}, {}}; }

/// Longitudes from `west` and latitudes from `north`, one node each `step` degrees.
Canvas degrees(int cols, int rows, double west, double north, double step) {
  return {{cols, rows}, {1, 1}, {{west, step, 0, north, 0, -step}, ""}};
}

const StepLaw kLaws[] = {StepLaw::equal, StepLaw::uniform, StepLaw::gaussian, StepLaw::exponential};
const CollageShape kShapes[] = {CollageShape::disc, CollageShape::rectangle, CollageShape::cone,
                                CollageShape::crater, CollageShape::hump};

double deviation(const Raster<float>& z) {
  double squares = 0;
  for (float v : z.cells()) squares += double(v) * double(v);
  return std::sqrt(squares / double(z.cells().size()));
}

bool all_finite(const Raster<float>& z) {
  return std::ranges::all_of(z.cells(), [](float v) { return std::isfinite(v); });
}

// ---- Straight faults

TEST(GenerateFaults, OneFaultMakesTwoLevelsOnEitherSideOfALine) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    FaultOptions o;
    o.count = 1, o.relief_m = 10, o.steps = StepLaw::equal, o.width_m = 0, o.seed = seed;
    const Raster<float> z = generate_faults(canvas(60, 40, 30), o);
    for (float v : z.cells()) ASSERT_EQ(std::abs(v), 10.0f);
    // Both sides are half-planes: along any row the level changes at most once, and the place of
    // the change moves by equal steps from row to row, give or take the rounding to cells.
    std::vector<double> change;
    for (int r = 0; r < 40; ++r) {
      int changes = 0, at = 0;
      for (int c = 1; c < 60; ++c)
        if (z(c, r) != z(c - 1, r)) ++changes, at = c;
      ASSERT_LE(changes, 1);
      if (changes == 1) change.push_back(at);
    }
    for (std::size_t i = 2; i < change.size(); ++i)
      EXPECT_LE(std::abs(change[i] - 2 * change[i - 1] + change[i - 2]), 1);
  }
}

TEST(GenerateFaults, ARampJoinsTheSidesOverItsWidth) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    FaultOptions o;
    o.count = 1, o.relief_m = 10, o.steps = StepLaw::equal, o.width_m = 300, o.seed = seed;
    const Raster<float> z = generate_faults(canvas(60, 60, 10), o);
    for (int r = 0; r < 60; ++r)
      for (int c = 0; c < 60; ++c) {
        EXPECT_LE(std::abs(z(c, r)), 10.0001f);
        // 20 m over 300 m of ground is 0.067 m to a metre, in any direction.
        if (c > 0) {
          EXPECT_LE(std::abs(z(c, r) - z(c - 1, r)), 10 * 20.0f / 300 + 1e-4f);
        }
        if (r > 0) {
          EXPECT_LE(std::abs(z(c, r) - z(c, r - 1)), 10 * 20.0f / 300 + 1e-4f);
        }
      }
  }
}

TEST(GenerateFaults, StepsAddUpToTheRelief) {
  for (StepLaw law : kLaws) {
    double squares = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      FaultOptions o;
      o.count = 300, o.relief_m = 500, o.steps = law, o.seed = seed;
      const double d = deviation(generate_faults(canvas(40, 40, 100), o));
      squares += d * d / 40;
    }
    // A terrain's heights hang together, so 40 terrains say some 40 independent things: 16 %.
    EXPECT_NEAR(std::sqrt(squares), 500, 160) << int(law);
  }
}

TEST(GenerateFaults, FinerCellsShowTheSameFaults) {
  // 4 x 4 fine cells around every coarse one: the extent, and so the lines, must be the same.
  FaultOptions o;
  o.count = 50, o.width_m = 0;
  const Raster<float> coarse = generate_faults(canvas(33, 33, 40), o);
  const Raster<float> fine = generate_faults(canvas(129, 129, 10), o);
  for (int r = 0; r < 33; ++r)
    for (int c = 0; c < 33; ++c) EXPECT_NEAR(coarse(c, r), fine(4 * c, 4 * r), 1e-3);
}

// ---- The globe

TEST(GenerateGlobe, HasNoSeamAtTheAntimeridian) {
  // Nodes at -180 and +180 degrees are the same places.
  const Raster<float> z = generate_globe(degrees(361, 179, -180, 89, 1), {.count = 300});
  for (int r = 0; r < 179; ++r) EXPECT_NEAR(z(0, r), z(360, r), 1e-3) << r;
  // And a window across it shows what the globe shows on both sides.
  const Raster<float> across = generate_globe(degrees(41, 21, 160, 10, 1), {.count = 300});
  for (int r = 0; r < 21; ++r)
    for (int c = 0; c < 41; ++c)
      EXPECT_NEAR(across(c, r), z((340 + c) % 360, r + 79), 1e-3) << c << ", " << r;
}

TEST(GenerateGlobe, HasOneHeightAtEachPole) {
  const Raster<float> z =
      generate_globe(degrees(73, 37, -180, 90, 5), {.count = 500, .off_centre = 0.5});
  for (int c = 1; c < 73; ++c) {
    EXPECT_NEAR(z(c, 0), z(0, 0), 1e-3);
    EXPECT_NEAR(z(c, 36), z(0, 36), 1e-3);
  }
}

TEST(GenerateGlobe, EveryCellIsOnTheSideItsPointIsOn) {
  // One circle: cells of each level are the points of one cap, told by a plane through three of
  // them. It is enough that the mean of the raised points is the cap's axis, and that the raised
  // are exactly those near it.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    GlobeOptions o;
    o.count = 1, o.relief_m = 1, o.steps = StepLaw::equal, o.off_centre = 0.6, o.seed = seed;
    const Raster<float> z = generate_globe(degrees(180, 90, -179, 89, 2), o);
    const auto point = [](int c, int r) {
      const double lon = (-179 + 2 * c) * std::numbers::pi / 180,
                   lat = (89 - 2 * r) * std::numbers::pi / 180;
      return std::array{std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon),
                        std::sin(lat)};
    };
    std::array<double, 3> axis{};
    for (int r = 0; r < 90; ++r)
      for (int c = 0; c < 180; ++c)
        for (std::size_t i = 0; i < 3; ++i)
          axis[i] +=
              double(z(c, r)) * point(c, r)[i] * std::cos((89 - 2 * r) * std::numbers::pi / 180);
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    double least_up = 1, most_down = -1;
    for (int r = 0; r < 90; ++r)
      for (int c = 0; c < 180; ++c) {
        double along = 0;
        for (std::size_t i = 0; i < 3; ++i) along += point(c, r)[i] * axis[i] / length;
        if (z(c, r) > 0) least_up = std::min(least_up, along);
        if (z(c, r) < 0) most_down = std::max(most_down, along);
      }
    // The axis is known to about the size of a cell, 2 degrees = 0.035.
    EXPECT_GT(least_up, most_down - 0.035) << seed;
  }
}

TEST(GenerateGlobe, GreatCirclesMirrorMountainsAsDeeps) {
  const Raster<float> z = generate_globe(degrees(72, 35, -180, 85, 5), {.count = 200});
  for (int r = 0; r < 35; ++r)
    for (int c = 0; c < 72; ++c) EXPECT_NEAR(z(c, r), -z((c + 36) % 72, 34 - r), 1e-2);
}

// ---- Collage

/// A round piece 100 m high of radius 1000 m that lies wholly on a canvas of 9.6 km.
Raster<float> one_piece(CollageShape shape) {
  CollageOptions o;
  o.shape = shape, o.count = 1, o.aspect = 1, o.steps = StepLaw::equal;
  o.sign = CollageSign::up, o.step_m = 100, o.radius_min_m = o.radius_max_m = 1000;
  for (o.seed = 1; o.seed < 1000; ++o.seed) {
    const Raster<float> z = generate_collage(canvas(241, 241, 40), o);
    bool inside = z(120, 120) > 0;
    for (int i = 0; i < 241; ++i)
      inside &= z(i, 0) == 0 && z(i, 240) == 0 && z(0, i) == 0 && z(240, i) == 0;
    if (inside) return z;
  }
  return {};
}

TEST(GenerateCollage, APieceHasTheVolumeOfItsShape) {
  const double pi = std::numbers::pi;
  for (const auto& [shape, volume] : {std::pair{CollageShape::disc, 100 * pi * 1e6},
                                      {CollageShape::rectangle, 100 * 4e6},
                                      {CollageShape::cone, 100 * pi * 1e6 / 3},
                                      {CollageShape::hump, 100 * pi * 1e6 / 3}}) {
    const Raster<float> z = one_piece(shape);
    ASSERT_FALSE(z.empty());
    double sum = 0;
    float top = 0;
    for (float v : z.cells()) sum += double(v) * 1600, top = std::max(top, v);
    EXPECT_NEAR(sum, volume, 0.05 * volume) << int(shape);  // 25 cells to a radius
    EXPECT_NEAR(top, 100, 4) << int(shape);
  }
}

TEST(GenerateCollage, ACraterIsHFOverFPlusSquaredDistance) {
  CollageOptions o;
  o.shape = CollageShape::crater, o.count = 1, o.aspect = 1, o.steps = StepLaw::equal;
  o.sign = CollageSign::down, o.step_m = 100, o.radius_min_m = o.radius_max_m = 500;
  const Raster<float> z = generate_collage(canvas(101, 101, 20), o);
  // H F / z = F + (x - x0)^2 + (y - y0)^2: its second differences are 2 dx^2 everywhere.
  const auto q = [&](int c, int r) { return -100 * 250000.0 / double(z(c, r)); };
  for (int r = 1; r < 100; r += 7)
    for (int c = 1; c < 100; c += 7) {
      EXPECT_NEAR(q(c - 1, r) - 2 * q(c, r) + q(c + 1, r), 800, 10);
      EXPECT_NEAR(q(c, r - 1) - 2 * q(c, r) + q(c, r + 1), 800, 10);
      EXPECT_NEAR(q(c + 1, r + 1) - q(c + 1, r) - q(c, r + 1) + q(c, r), 0, 10);
    }
}

TEST(GenerateCollage, UpRaisesAndDownLowersOnly) {
  for (CollageShape shape : kShapes)
    for (CollageSign sign : {CollageSign::up, CollageSign::down}) {
      CollageOptions o;
      o.shape = shape, o.count = 200, o.sign = sign;
      const Raster<float> z = generate_collage(canvas(50, 50, 100), o);
      for (float v : z.cells()) EXPECT_GE(sign == CollageSign::up ? v : -v, -1e-3f);
    }
}

// ---- All of them

TEST(Displacements, ThreadsDoNotChangeABit) {
  const dem::Run one{.threads = 1, .progress = {}}, many{.threads = 5, .progress = {}};
  const Canvas c = canvas(90, 130, 50);
  EXPECT_EQ(generate_faults(c, {}, one), generate_faults(c, {}, many));
  const Canvas globe = degrees(90, 45, -178, 88, 4);
  EXPECT_EQ(generate_globe(globe, {}, one), generate_globe(globe, {}, many));
  for (CollageShape shape : kShapes) {
    CollageOptions o;
    o.shape = shape, o.count = 500;
    EXPECT_EQ(generate_collage(c, o, one), generate_collage(c, o, many));
  }
}

TEST(Displacements, SmallCanvasesWork) {
  for (const Size size : {Size{1, 1}, Size{2, 1}, Size{1, 5}, Size{2, 2}}) {
    const Canvas c = canvas(size.cols, size.rows, 30);
    EXPECT_TRUE(all_finite(generate_faults(c, {.count = 20})));
    EXPECT_TRUE(all_finite(generate_globe(c, {.count = 20})));
    for (CollageShape shape : kShapes) {
      CollageOptions o;
      o.shape = shape, o.count = 20;
      EXPECT_TRUE(all_finite(generate_collage(c, o)));
    }
  }
}

TEST(Displacements, RefuseBadInputWithItsNameAndValue) {
  const auto refuses = [](auto call, const char* says) {
    EXPECT_THAT(call, ThrowsMessage<std::invalid_argument>(HasSubstr(says)));
  };
  const Canvas c = canvas(5, 5, 30);
  refuses([&] { generate_faults(canvas(0, 5, 30)); }, "size = 0 x 5");
  refuses([&] { generate_faults(c, {.count = 0}); }, "count = 0");
  refuses([&] { generate_faults(c, {.relief_m = -1}); }, "relief_m = -1");
  refuses([&] { generate_globe(degrees(4, 4, 0, 120, 10)); }, "latitude = 120");
  refuses([&] { generate_globe(c, {.off_centre = 2}); }, "off_centre = 2");
  CollageOptions o;
  o.radius_min_m = 9000;
  refuses([&] { generate_collage(c, o); }, "radius_min_m = 9000");
}

TEST(Displacements, StopWhenAskedTo) {
  const dem::Run stop{1, [](double, std::string_view) { return false; }};
  EXPECT_THROW(generate_faults(canvas(9, 9, 30), {}, stop), Cancelled);
  EXPECT_THROW(generate_globe(degrees(9, 9, 0, 40, 1), {}, stop), Cancelled);
  EXPECT_THROW(generate_collage(canvas(9, 9, 30), {}, stop), Cancelled);
}

}  // namespace
}  // namespace dem
