#include "dem/erosion.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Run one_thread{.threads = 1, .progress = {}};

/// Hills with some noise; a share of the cells unknown.
Dem hills(Size size, double unknown = 0, Spacing spacing = {30, 40}) {
  Dem dem{Raster<float>(size), Mask(size, 1), {}, spacing};
  for (int r = 0; r < size.rows; ++r)
    for (int c = 0; c < size.cols; ++c) {
      const std::uint64_t bits = random_bits(3, 1, c, r);
      dem.z(c, r) = float(900 + 300 * std::sin(c * 0.21) * std::cos(r * 0.17 + c * 0.05) +
                          20 * signed_uniform(bits));
      if ((signed_uniform(mix(bits)) + 1) / 2 < unknown) dem.known(c, r) = 0, dem.z(c, r) = -7;
    }
  return dem;
}

double total(const Dem& dem, const Raster<float>& z) {
  double sum = 0;
  for (std::size_t i = 0; i < z.cells().size(); ++i)
    if (dem.known.cells()[i]) sum += double(z.cells()[i]);
  return sum;
}

TEST(Erode, ConservesTerrainAndSediment) {
  for (bool open : {false, true})
    for (double unknown : {0.0, 0.1}) {
      const Dem dem = hills({97, 83}, unknown);
      ErosionOptions o;
      o.steps = 400, o.rain_mm = 50, o.open_border = open;
      const Eroded e = erode(dem, o, one_thread);
      EXPECT_NEAR(e.before_m3, e.after_m3 + e.carried_m3, 1e-9 * e.before_m3);
      EXPECT_NEAR(total(dem, dem.z) * 1200, e.before_m3, 1e-9 * e.before_m3);
      // The heights given are those, rounded to float32.
      EXPECT_NEAR(total(dem, e.z) * 1200, e.after_m3, 1e-7 * e.before_m3);
      if (open) {
        EXPECT_GT(e.carried_m3, 1e-6 * e.before_m3);
      } else {
        EXPECT_EQ(e.carried_m3, 0);
      }
    }
}

TEST(Erode, ConservesWaterBehindAClosedBorder) {
  const Dem dem = hills({60, 50});
  ErosionOptions o;
  o.steps = 100, o.rain_mm = 200, o.rain_mm_per_km = 0, o.rain_every = 25, o.open_border = false;
  const Eroded e = erode(dem, o, one_thread);
  EXPECT_NEAR(total(dem, e.water_m), 4 * 0.2 * 3000, 0.01);  // four rains on 3000 cells, float32
  for (float w : e.water_m.cells()) EXPECT_GE(w, 0.0f);
}

TEST(Erode, ThreadsDoNotChangeABit) {
  const Dem dem = hills({150, 211}, 0.02);
  ErosionOptions o;
  o.steps = 40, o.rain_every = 7;
  const Eroded one = erode(dem, o, one_thread),
               many = erode(dem, o, {.threads = 8, .progress = {}});
  EXPECT_EQ(one.z, many.z);
  EXPECT_EQ(one.water_m, many.water_m);
  EXPECT_EQ(one.carried_m3, many.carried_m3);
}

TEST(Erode, MirroredTerrainErodesMirrored) {
  // No direction comes first. Sums in another order may differ in their last bits.
  const Dem dem = hills({61, 40});
  Dem mirrored = dem;
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 61; ++c) mirrored.z(c, r) = dem.z(60 - c, 39 - r);
  ErosionOptions o;
  o.steps = 100;
  const Eroded a = erode(dem, o, one_thread), b = erode(mirrored, o, one_thread);
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 61; ++c) EXPECT_NEAR(a.z(c, r), b.z(60 - c, 39 - r), 1e-2);
}

TEST(Erode, LooseRockComesToRestAtTheTalusAngle) {
  // A wall of 400 m on a plain; after long weathering no slope is steeper than the talus.
  Dem dem{Raster<float>({60, 9}), Mask({60, 9}, 1), {}, {30, 30}};
  for (int r = 0; r < 9; ++r)
    for (int c = 20; c < 40; ++c) dem.z(c, r) = 400;
  ErosionOptions o;
  o.steps = 20000, o.rain_mm_per_km = 0, o.talus_deg = 30, o.c_t = 1;
  const Eroded e = erode(dem, o, one_thread);
  float steepest = 0;
  for (int r = 0; r < 9; ++r)
    for (int c = 1; c < 60; ++c) steepest = std::max(steepest, std::abs(e.z(c, r) - e.z(c - 1, r)));
  EXPECT_NEAR(double(steepest), 30 * std::tan(30 * std::numbers::pi / 180), 0.2);
}

TEST(Erode, TalusIsAnAngleOnTheGround) {
  // 20 m on 30 m is steeper than 30 degrees; the same on cells of 60 m is not.
  for (double cell : {30.0, 60.0}) {
    Dem dem{Raster<float>({9, 9}), Mask({9, 9}, 1), {}, {cell, cell}};
    for (int r = 0; r < 9; ++r)
      for (int c = 0; c < 9; ++c) dem.z(c, r) = float(20 * c);
    ErosionOptions o;
    o.steps = 1, o.rain_mm_per_km = 0, o.talus_deg = 30;
    const bool moved = erode(dem, o, one_thread).z != dem.z;
    EXPECT_EQ(moved, cell == 30.0);
  }
}

TEST(Erode, WaterStandsLevelInABasin) {
  Dem dem{Raster<float>({41, 41}), Mask({41, 41}, 1), {}, {30, 30}};
  for (int r = 0; r < 41; ++r)
    for (int c = 0; c < 41; ++c)
      dem.z(c, r) = float(0.02 * (std::pow(c - 20, 2) + std::pow(r - 20, 2)));
  ErosionOptions o;
  o.steps = 6000, o.rain_mm = 300, o.rain_mm_per_km = 0, o.rain_every = 1000000;
  o.K_c = 0, o.c_t = 0, o.open_border = false;
  const Eroded e = erode(dem, o, one_thread);
  EXPECT_EQ(e.z, dem.z);  // K_c = 0: clear water digs nothing
  float low = 1e9f, high = -1e9f;
  for (int r = 0; r < 41; ++r)
    for (int c = 0; c < 41; ++c)
      if (e.water_m(c, r) > 0.1f) {
        low = std::min(low, e.z(c, r) + e.water_m(c, r));
        high = std::max(high, e.z(c, r) + e.water_m(c, r));
      }
  EXPECT_GT(high, 0.0f);
  EXPECT_LT(high - low, 0.02f);
}

TEST(Erode, RiversDigAndPlainsFill) {
  const Dem dem = hills({100, 100}, 0, {30, 30});
  ErosionOptions o;
  o.steps = 500, o.c_t = 0;
  const Eroded e = erode(dem, o, one_thread);
  float lowest = 1e9f, highest = -1e9f, dug = 0, filled = 0;
  for (std::size_t i = 0; i < e.z.cells().size(); ++i) {
    lowest = std::min(lowest, dem.z.cells()[i]), highest = std::max(highest, dem.z.cells()[i]);
    dug = std::min(dug, e.z.cells()[i] - dem.z.cells()[i]);
    filled = std::max(filled, e.z.cells()[i] - dem.z.cells()[i]);
  }
  EXPECT_LT(dug, -5.0f);
  EXPECT_GT(filled, 5.0f);
  for (float z : e.z.cells()) {  // nothing is dug below what lay lowest, nor piled above the top
    EXPECT_GE(z, lowest - 1);
    EXPECT_LE(z, highest + 1);
  }
}

TEST(Erode, StaysWithinBoundsUnderStrongSettings) {
  ErosionOptions o;
  o.steps = 1000, o.rain_mm = 1000, o.rain_every = 1, o.K_c = 100, o.K_s = 1, o.K_d = 1, o.c_t = 1;
  o.talus_deg = 0;
  const Eroded e = erode(hills({40, 40}), o, one_thread);
  const auto [low, high] = std::ranges::minmax(e.z.cells());
  EXPECT_GT(low, -2000.0f);
  EXPECT_LT(high, 2000.0f);
}

TEST(Erode, UnknownCellsStayAndAreWalls) {
  // A wall of unknown cells parts the map: what happens west of it does not change the east.
  Dem a = hills({41, 30});
  for (int r = 0; r < 30; ++r)
    a.known(20, r) = 0, a.z(20, r) = std::numeric_limits<float>::quiet_NaN();
  Dem b = a;
  for (int r = 0; r < 30; ++r)
    for (int c = 0; c < 20; ++c) b.z(c, r) += float(10 + r);
  ErosionOptions o;
  o.steps = 120, o.rain_mm = 100, o.rain_mm_per_km = 0;
  const Eroded first = erode(a, o, one_thread), second = erode(b, o, one_thread);
  for (int r = 0; r < 30; ++r) {
    EXPECT_TRUE(std::isnan(first.z(20, r)));
    EXPECT_EQ(first.water_m(20, r), 0.0f);
    for (int c = 21; c < 41; ++c) EXPECT_EQ(first.z(c, r), second.z(c, r));
  }
}

TEST(Erode, NoStepsChangeNothing) {
  const Dem dem = hills({20, 20});
  EXPECT_EQ(erode(dem, {.steps = 0}).z, dem.z);
}

TEST(Erode, SmallDemsWork) {
  for (const Size size : {Size{1, 1}, Size{2, 1}, Size{1, 7}, Size{2, 2}, Size{3, 3}})
    for (bool open : {false, true}) {
      ErosionOptions o;
      o.steps = 10, o.open_border = open;
      const Eroded e = erode(hills(size), o, one_thread);
      for (float z : e.z.cells()) EXPECT_TRUE(std::isfinite(z));
    }
}

TEST(Erode, FramesComeEveryNStepsAndTheLastIsTheResult) {
  const Dem dem = hills({30, 30});
  ErosionOptions o;
  o.steps = 60;
  std::vector<int> steps;
  Raster<float> last;
  const Eroded e = erode(dem, o, one_thread, {20, [&](const ErosionFrame& f) {
                                                steps.push_back(f.step);
                                                last = f.z;
                                              }});
  EXPECT_THAT(steps, ::testing::ElementsAre(20, 40, 60));
  EXPECT_EQ(last, e.z);
}

TEST(Erode, RefusesBadInputWithItsNameAndValue) {
  const auto refuses = [](const Dem& dem, const ErosionOptions& o, const char* says) {
    EXPECT_THAT([&] { erode(dem, o); }, ThrowsMessage<std::invalid_argument>(HasSubstr(says)));
  };
  Dem dem = hills({5, 5});
  refuses(dem, {.talus_deg = -1}, "talus_deg = -1");
  refuses(dem, {.c_t = 2}, "c_t = 2");
  refuses(dem, {.K_d = std::numeric_limits<double>::quiet_NaN()}, "K_d = nan");
  refuses({}, {}, "must be at least 1 x 1");
  dem.z(3, 2) = std::numeric_limits<float>::quiet_NaN();
  refuses(dem, {}, "z(3, 2) = nan; must be finite where known");
  dem = hills({5, 5});
  dem.spacing.dx_m = 0;
  refuses(dem, {}, "spacing = 0 x 40 m");
  dem.known = Mask({5, 5});
  refuses(dem, {}, "no known cell");
}

TEST(Erode, StopsWhenAskedTo) {
  const dem::Run stop{1, [](double, std::string_view) { return false; }};
  EXPECT_THROW(erode(hills({9, 9}), {}, stop), Cancelled);
}

}  // namespace
}  // namespace dem
