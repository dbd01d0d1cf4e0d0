#include "dem/riverland.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>

#include "synthesis/riverland_parts.h"

namespace dem {
using namespace synthesis;
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Spacing cell_30{30, 30};
const Run one_thread{1, {}};

Land whole(Size size) { return {Mask(size, 1), {}, {}}; }

/// Cells from which falling steps alone lead to the sea, the coast or a river, up from those.
Mask drained(const Land& land, const RiverLand& made) {
  const Country country(land, cell_30);
  Mask seen(made.z.size());
  std::deque<Cell> queue;
  for (int row = 0; row < seen.rows(); ++row)
    for (int col = 0; col < seen.cols(); ++col)
      if (!land.land(col, row) || country.coast(col, row) || made.wet(col, row)) {
        seen(col, row) = 1;
        queue.push_back({col, row});
      }
  while (!queue.empty()) {
    const Cell from = queue.front();
    queue.pop_front();
    for (int r = from.row - 1; r <= from.row + 1; ++r)
      for (int c = from.col - 1; c <= from.col + 1; ++c) {
        if (!seen.contains(c, r) || seen(c, r)) continue;
        if (made.z(c, r) <= made.z(from.col, from.row)) continue;
        seen(c, r) = 1;
        queue.push_back({c, r});
      }
  }
  return seen;
}

/// Steps along rivers that do not fall, or whose cells are no neighbours.
int faults_along(const RiverLand& made) {
  int faults = 0;
  for (const River& river : made.rivers)
    for (std::size_t i = 1; i < river.path.size(); ++i) {
      const Cell a = river.path[i - 1], b = river.path[i];
      const int step = std::max(std::abs(a.col - b.col), std::abs(a.row - b.row));
      faults += step != 1 || made.z(b.col, b.row) >= made.z(a.col, a.row);
    }
  return faults;
}

TEST(RiverLand, EveryLandCellDrainsAndRiversFall) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    for (auto profile : {SlopeProfile::linear, SlopeProfile::concave, SlopeProfile::cliffs,
                         SlopeProfile::terraces}) {
      const Size size{seed % 2 ? 257 : 300, 257};
      Land land = seed % 2 ? make_island(size, seed, one_thread) : whole(size);
      land.rocks = Mask(size, 1);
      land.ridges = {{{120, 100, 600, 1500}, {180, 140, 400, 1000}}};
      const RiverLand made =
          make_riverland(land, cell_30, {.profile = profile, .seed = seed}, one_thread);
      EXPECT_EQ(faults_along(made), 0) << seed;
      const Mask seen = drained(land, made);
      EXPECT_EQ(count(seen), seen.cells().size()) << seed;
      for (std::size_t i = 0; i < seen.cells().size(); ++i)
        ASSERT_TRUE(land.land.cells()[i] || made.z.cells()[i] == 0);
      for (float z : made.z.cells()) ASSERT_TRUE(std::isfinite(z) && z >= 0);
    }
}

TEST(RiverLand, RiversEndAtTheCoastOrOnAnotherAndMouthsKeepTheirDistance) {
  const Land land = make_island({257, 257}, 3, one_thread);
  const Country country(land, cell_30);
  const RiverLandOptions options{.mouth_distance_m = 1500, .seed = 3};
  const RiverLand made = make_riverland(land, cell_30, options, one_thread);
  std::vector<Cell> mouths;
  for (const River& river : made.rivers) {
    const Cell end = river.path.back();
    if (river.joins >= 0) {
      const auto& other = made.rivers[std::size_t(river.joins)].path;
      EXPECT_NE(std::ranges::find(other, end), other.end());
      continue;
    }
    EXPECT_TRUE(country.coast(end.col, end.row));
    for (Cell other : mouths) EXPECT_GE(country.distance_m(end, other), options.mouth_distance_m);
    mouths.push_back(end);
  }
  EXPECT_GT(mouths.size(), 3U);
  EXPECT_GT(made.rivers.size(), mouths.size());  // there are tributaries
}

TEST(RiverLand, LevelsComeFromAverageSlopeAndAreSteeperTowardTheSource) {
  const Land land = whole({257, 257});
  const RiverLandOptions options{.river_slope = 0.01, .head_m = 600, .head_steepness = 5};
  const RiverLand made = make_riverland(land, cell_30, options, one_thread);
  double low = 0, low_way = 0, head = 0, head_way = 0;
  const Country country(land, cell_30);
  for (const River& river : made.rivers) {
    double way = 0;
    for (std::size_t i = 1; i < river.path.size(); ++i) {
      const Cell a = river.path[i - 1], b = river.path[i];
      const double step = country.distance_m(a, b);
      const double fall = double(made.z(a.col, a.row)) - double(made.z(b.col, b.row));
      way += step;
      (way < options.head_m ? head : low) += fall;
      (way < options.head_m ? head_way : low_way) += step;
    }
  }
  EXPECT_NEAR(low / low_way, options.river_slope, 0.3 * options.river_slope);
  EXPECT_NEAR(head / head_way, 3 * options.river_slope, options.river_slope);  // 5 to 1, mean 3
}

TEST(RiverLand, ValleysAreTheShortestWaysWeightedBySlope) {
  const Land land = whole({90, 70});
  const Country country(land, cell_30);
  const RiverLandOptions options{.segment_m = 300, .seed = 2};
  const UserRidges none(country, options);
  const auto rivers = grow_meanders(country, none, options, {});
  const Water water = fill_rivers(country, none, rivers, options);
  const Valleys v = find_valleys(country, water, options, {});
  // The oracle: relax every cell again and again.
  Raster<float> rise(country.size(), far_away), slope(country.size());
  for (int row = 0; row < 70; ++row)
    for (int col = 0; col < 90; ++col)
      if (water.wet(col, row) || country.coast(col, row))
        rise(col, row) = 0, slope(col, row) = v.slope(col, row);
  for (bool changed = true; changed;) {
    changed = false;
    for (int row = 0; row < 70; ++row)
      for (int col = 0; col < 90; ++col)
        for (int r = std::max(0, row - 1); r <= std::min(69, row + 1); ++r)
          for (int c = std::max(0, col - 1); c <= std::min(89, col + 1); ++c) {
            const float way = float(country.distance_m({c, r}, {col, row}));
            const float there = rise(c, r) + slope(c, r) * way;
            if (there < rise(col, row))
              rise(col, row) = there, slope(col, row) = slope(c, r), changed = true;
          }
  }
  // The slope travels with the way, so the last bit of a tie may choose another; rises agree.
  std::size_t apart = 0;
  for (std::size_t i = 0; i < rise.cells().size(); ++i)
    apart += std::abs(rise.cells()[i] - v.rise.cells()[i]) > 0.01F * (1 + rise.cells()[i]);
  EXPECT_LT(apart, rise.cells().size() / 100);
  EXPECT_EQ(v.order.size(), rise.cells().size());
}

TEST(RiverLand, RemovesCliffsSteeperThanTheThreshold) {
  const Land land = whole({200, 200});
  const Country country(land, cell_30);
  const auto steepest = [&](double cliff_slope) {
    const RiverLandOptions o{.slope = 0.2, .cliff_slope = cliff_slope, .seed = 4};
    const UserRidges none(country, o);
    const auto rivers = grow_meanders(country, none, o, {});
    const Water water = fill_rivers(country, none, rivers, o);
    const Raster<float> z = raise_land(country, water, find_valleys(country, water, o, {}), o, {});
    double most = 0;
    for (int row = 0; row < 200; ++row)
      for (int col = 1; col < 200; ++col)
        if (!water.wet(col, row) && !water.wet(col - 1, row) && !country.coast(col, row) &&
            !country.coast(col - 1, row))
          most = std::max(most, std::abs(double(z(col, row) - z(col - 1, row))) / 30);
    return most;
  };
  EXPECT_LE(steepest(0.5), 0.5 * 1.001);  // float32 heights of hundreds of metres
  EXPECT_GT(steepest(1000), 0.6);
}

TEST(RiverLand, ProfilesRiseAndAgreeWithTheirDescriptions) {
  for (auto p : {SlopeProfile::linear, SlopeProfile::concave, SlopeProfile::convex,
                 SlopeProfile::trough, SlopeProfile::cliffs, SlopeProfile::terraces}) {
    double before = -1;
    for (double x = 0; x < 6; x += 0.01) {
      const double h = x * profile_factor(p, x);
      EXPECT_GE(h, before) << int(p) << " at " << x;
      before = h;
    }
  }
  EXPECT_EQ(profile_factor(SlopeProfile::linear, 3), 1);
  EXPECT_LT(profile_factor(SlopeProfile::concave, 0.1), 0.2);  // flat floor
  EXPECT_GT(profile_factor(SlopeProfile::convex, 0.1), 1.5);   // steep banks
  EXPECT_GT(1.1 * profile_factor(SlopeProfile::cliffs, 1.1) -
                1.0 * profile_factor(SlopeProfile::cliffs, 1.0),
            0.9);  // the cliff
}

TEST(RiverLand, UserRidgesStandAsHighAndAsWideAsAsked) {
  Land land = whole({257, 257});
  land.ridges = {{{80, 128, 1000, 1500}, {176, 128, 1000, 1500}}};
  const Country country(land, cell_30);
  const RiverLandOptions options{.ridge_roughness = 0};
  const UserRidges ridges(country, options);
  EXPECT_FLOAT_EQ(ridges.z(128, 128), 1000);
  EXPECT_NEAR(ridges.z(128, 128 - 25), 500, 1);  // 750 m away, half of the width
  EXPECT_EQ(ridges.z(128, 128 - 51), 0);
  EXPECT_EQ(count(ridges.line), 97U);
  // No river crosses it.
  for (const auto& river : grow_meanders(country, ridges, options, {}))
    for (Cell c : river.path) EXPECT_FALSE(ridges.line(c.col, c.row));
  // And the terrain has it, but where rivers cut.
  const RiverLand made = make_riverland(land, cell_30, options, one_thread);
  int high = 0;
  for (int col = 80; col <= 176; ++col) high += made.z(col, 128) > 800;
  EXPECT_GT(high, 80);
}

TEST(RiverLand, RocksStandInTheirPatchAndLeaveRiversAlone) {
  Land plain = whole({257, 257}), rocky = plain;
  rocky.rocks = Mask(rocky.land.size());
  for (int row = 100; row < 160; ++row)
    for (int col = 100; col < 160; ++col) rocky.rocks(col, row) = 1;
  const RiverLandOptions options{.seed = 5};
  const RiverLand a = make_riverland(plain, cell_30, options, one_thread);
  const RiverLand b = make_riverland(rocky, cell_30, options, one_thread);
  double rise = 0;
  for (int row = 100; row < 160; ++row)
    for (int col = 100; col < 160; ++col)
      rise = std::max(rise, double(b.z(col, row) - a.z(col, row)));
  EXPECT_GT(rise, options.rock_height_m / 2);
  EXPECT_EQ(a.wet, b.wet);
  for (const River& river : a.rivers)
    for (Cell c : river.path) EXPECT_EQ(a.z(c.col, c.row), b.z(c.col, c.row));
}

TEST(RiverLand, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Land land = whole({129, 129});
  const auto make = [&](std::uint64_t seed) {
    return make_riverland(land, cell_30, {.segment_m = 400, .seed = seed}, one_thread).z;
  };
  EXPECT_EQ(make(1), make(1));
  EXPECT_NE(make(1), make(2));
}

TEST(RiverLand, ReadsLandFromGreys) {
  Raster<float> drawing({3, 1});
  drawing(0, 0) = 0.1F, drawing(1, 0) = 0.5F, drawing(2, 0) = 0.9F;
  const Land land = read_land(drawing);
  EXPECT_THAT(land.land.cells(), ::testing::ElementsAre(0, 1, 1));
  EXPECT_THAT(land.rocks.cells(), ::testing::ElementsAre(0, 1, 0));
}

TEST(RiverLand, RefusesWhatCannotBe) {
  const auto refusal = [](Land land, RiverLandOptions o = {}) {
    return [=] { make_riverland(land, cell_30, o, one_thread); };
  };
  using Bad = std::invalid_argument;
  for (int side : {0, 1, 2, 15})
    EXPECT_THAT(refusal(whole({side, side})),
                ThrowsMessage<Bad>(HasSubstr("must be at least 16 x 16 cells")));
  EXPECT_THAT(refusal({Mask({64, 64}), {}, {}}), ThrowsMessage<Bad>(HasSubstr("has no land")));
  EXPECT_THAT(refusal(whole({64, 64}), {.segment_m = 5000}),
              ThrowsMessage<Bad>(HasSubstr("the land has no room for a river")));
  Land outside = whole({129, 129});
  outside.ridges = {{{-50, -50, 100, 100}, {-20, -20, 100, 100}}};
  EXPECT_THAT(refusal(outside), ThrowsMessage<Bad>(HasSubstr("ridge 1 has no cell on the land")));
  outside.ridges = {{{5, 5, 100, 100}}};
  EXPECT_THAT(refusal(outside), ThrowsMessage<Bad>(HasSubstr("ridge 1 has 1 points")));
  outside.ridges = {{{5, 5, 100, 0}, {9, 9, 100, 100}}};
  EXPECT_THAT(refusal(outside), ThrowsMessage<Bad>(HasSubstr("wider than 0")));
  EXPECT_THAT(refusal(whole({64, 64}), {.mouths = 0}),
              ThrowsMessage<Bad>(HasSubstr("mouths = 0; must be a whole number in [1, 10000]")));
  Land odd = whole({64, 64});
  odd.rocks = Mask({3, 3});
  EXPECT_THAT(refusal(odd), ThrowsMessage<Bad>(HasSubstr("rocks is 3 x 3; must be 64 x 64")));
}

TEST(RiverLand, StopsWhenAsked) {
  const dem::Run stop{1, [](double, std::string_view) { return false; }};
  EXPECT_THROW(make_riverland(whole({129, 129}), cell_30, {}, stop), Cancelled);
}

}  // namespace
}  // namespace dem
