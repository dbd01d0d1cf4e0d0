#include "dem/networks.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <numeric>
#include <set>

#include "synthesis/flood.h"
#include "synthesis/growth.h"

namespace dem {
using namespace numeric;
using namespace synthesis;
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Spacing cell_30{30, 30};
const Run one_thread{1, {}};

/// The steps of all rivers on which `z` rises, and the cells that are not neighbours.
int faults_along(const std::vector<River>& rivers, const Raster<float>& z) {
  int faults = 0;
  for (const River& river : rivers)
    for (std::size_t i = 1; i < river.path.size(); ++i) {
      const Cell a = river.path[i - 1], b = river.path[i];
      const int step = std::max(std::abs(a.col - b.col), std::abs(a.row - b.row));
      faults += step != 1 || z(b.col, b.row) > z(a.col, a.row);
    }
  return faults;
}

bool on_edge(Size size, Cell c) {
  return c.col == 0 || c.row == 0 || c.col == size.cols - 1 || c.row == size.rows - 1;
}

TEST(GrowSkeleton, RiversNeverRiseTowardTheirMouthsInSkeletonAndTerrain) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    for (Size size : {Size{257, 257}, Size{300, 120}}) {
      const Skeleton s = grow_skeleton(size, cell_30, {.seed = seed}, one_thread);
      EXPECT_EQ(faults_along(s.rivers, s.dem.z), 0) << seed;
      for (auto fill : {SkeletonFill::mcmd, SkeletonFill::mdi}) {
        const Raster<float> z = fill_skeleton(s, {.fill = fill, .rs = 1, .rs_bu = 1}, one_thread);
        EXPECT_EQ(faults_along(s.rivers, z), 0) << seed;
        for (float h : z.cells()) ASSERT_TRUE(std::isfinite(h));
      }
    }
}

TEST(GrowSkeleton, KeepsOnlyRiversThatLeaveTheMapOrJoinOneThatDoes) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Skeleton s = grow_skeleton({257, 257}, cell_30, {.seed = seed}, one_thread);
    std::set<std::pair<int, int>> cells;
    for (const River& river : s.rivers) {
      const Cell end = river.path.back();
      if (river.joins < 0) {
        EXPECT_TRUE(on_edge(s.dem.size(), end)) << seed;
      } else {
        const auto& other = s.rivers[std::size_t(river.joins)].path;
        EXPECT_NE(std::ranges::find(other, end), other.end()) << seed;
      }
      // No two rivers share a cell but a confluence, and none crosses itself.
      for (std::size_t i = 0; i + (river.joins >= 0) < river.path.size(); ++i)
        EXPECT_TRUE(cells.insert({river.path[i].col, river.path[i].row}).second) << seed;
    }
  }
}

TEST(GrowSkeleton, MassesOfMouthsAreTheNumberOfSources) {
  const Skeleton s = grow_skeleton({257, 257}, cell_30, {.seed = 3}, one_thread);
  double at_mouths = 0;
  int confluences = 0;
  for (const River& river : s.rivers) {
    if (river.joins < 0) at_mouths += river.mass;
    confluences += river.joins >= 0;
  }
  EXPECT_EQ(at_mouths, double(s.rivers.size()));
  EXPECT_GT(confluences, 10);
}

TEST(GrowSkeleton, KnowsTheCellsOfItsLinesAndNoOthers) {
  const Skeleton s = grow_skeleton({200, 257}, cell_30, {.seed = 5}, one_thread);
  std::size_t ridge = 0, river = 0;
  for (std::size_t i = 0; i < s.kinds.cells().size(); ++i) {
    const CellKind kind = s.kinds.cells()[i];
    EXPECT_EQ(s.dem.known.cells()[i] != 0, kind != CellKind::plain);
    ridge += kind == CellKind::ridge, river += kind == CellKind::river;
  }
  EXPECT_GT(ridge, 500U);
  EXPECT_GT(river, 500U);
  EXPECT_LT(ridge + river, s.kinds.cells().size() / 5);
}

TEST(GrowSkeleton, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const auto grow = [](std::uint64_t seed) {
    return grow_skeleton({129, 129}, cell_30, {.seed = seed}, one_thread);
  };
  EXPECT_EQ(grow(1).dem.z, grow(1).dem.z);
  EXPECT_NE(grow(1).dem.z, grow(2).dem.z);
}

TEST(GrowSkeleton, RidgesFallFromTheirMiddleAsAGaussian) {
  const Map map({1025, 1025}, cell_30);
  const NetworkOptions options{
      .ridges = 1, .ridge_variation = 0, .ridge_length = 0.1, .ridge_wander = 0};
  const auto ridge = grow_ridges(map, options, {});
  const Point middle = map.centre_of(ridge.front().cell);
  for (const auto& r : ridge) {
    const double d = length(map.centre_of(r.cell) - middle) / options.ridge_length;
    EXPECT_NEAR(bell(r.fall), std::exp(-d * d / 2), 0.02);  // bell: 0.01; a step and half a cell
  }
}

TEST(GrowSkeleton, GroundIsTheHighestOfTheCrossSections) {
  const Map map({257, 257}, cell_30);
  const NetworkOptions options{.ridges = 3, .dome = 0, .seed = 4};
  const auto ridges = grow_ridges(map, options, {});
  const Ground ground(map, ridges, options);
  const double sigma = options.ridge_length * options.ridge_width;
  double worst = 0;
  for (int row = 8; row < 257; row += 16)
    for (int col = 8; col < 257; col += 16) {
      const Point p = map.centre_of({col, row});
      double highest = 0;
      for (const auto& r : ridges) {
        const double d = length(map.centre_of(r.cell) - p) / sigma;
        highest = std::max(highest, bell(r.fall + d * d / 2));
      }
      worst = std::max(worst, std::abs(ground.altitude_m(p) / options.ridge_height_m - highest));
    }
  EXPECT_LT(worst, 0.03);  // nodes of 1 / 256, smoothed
}

TEST(GrowSkeleton, RefusesWhatCannotBe) {
  const auto refusal = [](Size size, NetworkOptions o) {
    return [=] { grow_skeleton(size, cell_30, o, one_thread); };
  };
  for (int side : {0, 1, 2, 15})
    EXPECT_THAT(refusal({side, side}, {}),
                ThrowsMessage<std::invalid_argument>(HasSubstr("must be at least 16 x 16")));
  EXPECT_THAT(refusal({2'000'000'000, 2'000'000'000}, {}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("must be at most 268435456 cells")));
  EXPECT_THAT(refusal({64, 64}, {.ridges = 0}),
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("ridges = 0; must be a whole number in [1, 1000]")));
  EXPECT_THAT(
      [] {
        grow_skeleton({64, 64}, {0, 30});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("spacing = 0 x 30 m")));
}

TEST(GrowSkeleton, StopsWhenAsked) {
  const dem::Run stop{1, [](double, std::string_view) { return false; }};
  EXPECT_THROW(grow_skeleton({257, 257}, cell_30, {}, stop), Cancelled);
}

// ---- Drawn by a user

/// A white drawing with a river from the middle to the bottom, a brook that joins it, and a ridge.
Raster<float> drawing() {
  Raster<float> d({65, 65}, 1);
  for (int row = 30; row < 65; ++row) d(32 + (row / 6) % 2, row) = 0.25F;
  for (int col = 10; col < 32; ++col) d(col, 50) = 0.1F;
  for (int col = 5; col < 60; ++col) d(col, 12) = 0.75F;
  return d;
}

TEST(ReadSkeleton, RiversNeverRiseTowardTheirMouths) {
  for (auto heights : {LineHeights::generated, LineHeights::given}) {
    const Skeleton s = read_skeleton(drawing(), cell_30, {.heights = heights});
    ASSERT_GE(s.rivers.size(), 2U);
    EXPECT_EQ(faults_along(s.rivers, s.dem.z), 0);
    EXPECT_EQ(faults_along(s.rivers, fill_skeleton(s)), 0);
    EXPECT_EQ(s.rivers[0].path.back(), (Cell{32, 64}));
  }
}

TEST(ReadSkeleton, TakesTheGreysAsHeightsWhenTheyAreGiven) {
  const Skeleton s = read_skeleton(drawing(), cell_30,
                                   {.heights = LineHeights::given, .low_m = 100, .high_m = 500});
  EXPECT_FLOAT_EQ(s.dem.z(20, 12), 400);  // ridge, grey 0.75
  EXPECT_FLOAT_EQ(s.dem.z(32, 64), 200);  // mouth, grey 0.25
  EXPECT_FLOAT_EQ(s.dem.z(10, 50), 200);  // grey 0.1 = 140 m would be below the mouth
}

TEST(ReadSkeleton, GeneratesRiversBySlopeAndRidgesAboveThem) {
  const Skeleton s = read_skeleton(drawing(), cell_30, {.river_slope = 0.1, .ridge_slope = 0.5});
  EXPECT_FLOAT_EQ(s.dem.z(32, 64), 0);
  EXPECT_FLOAT_EQ(s.dem.z(32, 62), 6);    // two steps of 30 m
  EXPECT_FLOAT_EQ(s.dem.z(20, 12), 180);  // 12 steps from the edge
  EXPECT_EQ(s.kinds(20, 12), CellKind::ridge);
  EXPECT_EQ(s.kinds(20, 50), CellKind::river);
  EXPECT_EQ(s.kinds(0, 0), CellKind::plain);
}

TEST(ReadSkeleton, GivesARiverThatEndsInsideItsMouthNearestToTheEdge) {
  Raster<float> d({65, 65}, 1);
  for (int col = 8; col < 40; ++col) d(col, 30) = 0;
  const Skeleton s = read_skeleton(d, cell_30);
  ASSERT_EQ(s.rivers.size(), 1U);
  EXPECT_EQ(s.rivers[0].path.back(), (Cell{8, 30}));
}

TEST(ReadSkeleton, RefusesDrawingsWithoutLinesOrRoom) {
  const auto refusal = [](float grey) {
    return [=] { read_skeleton(Raster<float>({20, 20}, grey), cell_30); };
  };
  EXPECT_THAT(refusal(1), ThrowsMessage<std::invalid_argument>(HasSubstr("all white")));
  EXPECT_THAT(refusal(0), ThrowsMessage<std::invalid_argument>(HasSubstr("no white")));
  EXPECT_THAT([] { read_skeleton({}, cell_30); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("size = 0 x 0")));
}

// ---- Filling of depressions

TEST(FillDepressions, LeavesNoPitAndRaisesNoMoreThanNeeded) {
  Raster<float> z({60, 40});
  for (int row = 0; row < 40; ++row)
    for (int col = 0; col < 60; ++col)
      z(col, row) = float(100 + 99 * signed_uniform(random_bits(1, 2, col, row)));
  Mask outlets(z.size());
  for (int col = 0; col < 60; ++col) outlets(col, 0) = 1;
  Raster<float> filled = z;
  fill_depressions(filled, outlets, 0, {});

  // The oracle: raise again and again, until nothing changes, from above.
  Raster<float> oracle(z.size(), 1e9F);
  for (int col = 0; col < 60; ++col) oracle(col, 0) = z(col, 0);
  for (bool changed = true; changed;) {
    changed = false;
    for (int row = 1; row < 40; ++row)
      for (int col = 0; col < 60; ++col) {
        float lowest = 1e9F;
        for (int r = std::max(0, row - 1); r <= std::min(39, row + 1); ++r)
          for (int c = std::max(0, col - 1); c <= std::min(59, col + 1); ++c)
            if (r != row || c != col) lowest = std::min(lowest, oracle(c, r));
        const float h = std::max(z(col, row), std::nextafter(lowest, 1e9F));
        if (h < oracle(col, row)) oracle(col, row) = h, changed = true;
      }
  }
  EXPECT_EQ(filled, oracle);
}

}  // namespace
}  // namespace dem
