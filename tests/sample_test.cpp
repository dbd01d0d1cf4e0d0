#include "dem/sample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <stdexcept>

#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

/// Rough ground of whole metres by integer arithmetic; every ninth cell or so unknown on request.
Dem ground(Size size, bool holes = false) {
  Dem dem{Raster<float>(size), Mask(size, 1), {}, {70, 90}};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      const auto noise = below(random_bits(5, 0, col, row), 40);
      const auto hills = below(random_bits(6, 0, col / 16, row / 16), 900);
      dem.z(col, row) = float(noise + hills) + 1;
      if (holes && below(random_bits(7, 0, col, row), 9) == 0) dem.known(col, row) = 0;
    }
  return dem;
}

/// A plane of `east` metres per column and `south` metres per row.
Dem plane(Size size, float east, float south) {
  Dem dem{Raster<float>(size), Mask(size, 1), {}, {}};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      dem.z(col, row) = east * float(col) + south * float(row);
  return dem;
}

/// A number that stands for the set of known cells.
std::uint64_t hash(const Mask& known) {
  std::uint64_t h = 0;
  for (int row = 0; row < known.rows(); ++row)
    for (int col = 0; col < known.cols(); ++col)
      if (known(col, row)) h += random_bits(1, 2, col, row);
  return h;
}

/// Kept cells were known and kept their height; the others' heights are wiped.
void expect_part_of(const Dem& part, const Dem& whole) {
  ASSERT_EQ(part.size(), whole.size());
  EXPECT_EQ(part.spacing, whole.spacing);
  for (std::size_t i = 0; i < whole.z.cells().size(); ++i) {
    if (part.known.cells()[i]) {
      ASSERT_EQ(whole.known.cells()[i], 1);
      ASSERT_EQ(std::bit_cast<std::uint32_t>(part.z.cells()[i]),
                std::bit_cast<std::uint32_t>(whole.z.cells()[i]));
    } else {
      ASSERT_EQ(part.z.cells()[i], 0);
    }
  }
}

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing was thrown";
}

TEST(SampleRandom, KeepsExactlyTheCountAskedFor) {
  const Dem whole = ground({1025, 1025});
  const Dem part = sample_random(whole, 35721, 3);
  EXPECT_EQ(count(part.known), 35721u);
  expect_part_of(part, whole);
}

TEST(SampleRandom, TakesOnlyKnownCells) {
  const Dem whole = ground({60, 41}, true);
  for (const std::size_t keep : {std::size_t(1), std::size_t(700), count(whole.known)}) {
    const Dem part = sample_random(whole, keep);
    EXPECT_EQ(count(part.known), keep);
    expect_part_of(part, whole);
  }
}

TEST(SampleRandom, TakesEverySubsetEquallyOften) {
  // 2 of 4 cells: 6 subsets. 6000 seeds give each 1000 times, with a standard deviation of 29.
  const Dem whole = plane({2, 2}, 1, 1);
  std::map<std::uint64_t, int> times;
  for (std::uint64_t seed = 0; seed < 6000; ++seed)
    ++times[hash(sample_random(whole, 2, seed).known)];
  EXPECT_EQ(times.size(), 6u);
  for (const auto& [subset, n] : times) EXPECT_NEAR(n, 1000, 5 * 29);
}

TEST(SampleRandom, RefusesWhatCannotBeKept) {
  const Dem whole = ground({4, 4});
  EXPECT_EQ(message_of([&] { sample_random(whole, 0); }),
            "keep = 0; must be in [1, 16] for the known cells there are");
  EXPECT_THROW(sample_random(whole, 17), std::invalid_argument);
  Dem none = whole;
  none.known = Mask(whole.size(), 0);
  EXPECT_THROW(sample_random(none, 1), std::invalid_argument);
}

TEST(Sample, GivesTheSameCellsOnEveryMachine) {
  const Dem whole = ground({200, 150}, true);
  EXPECT_EQ(hash(sample_random(whole, 1000, 42).known), 7748761912302780592u);
  EXPECT_EQ(hash(sample_edges(whole, 2000).known), 17424464588466572945u);
  EXPECT_EQ(hash(sample_voids(whole, {.remove = 3000, .seed = 42}).known), 4742535657291433448u);
  EXPECT_EQ(hash(sample_tracks(whole, 9, 42).known), 3070193911278563474u);
  EXPECT_EQ(hash(sample_contours(whole, 20).known), 7127290007494284686u);
}

TEST(Sample, AnotherSeedGivesOtherCells) {
  const Dem whole = ground({100, 100});
  EXPECT_NE(sample_random(whole, 500, 1).known, sample_random(whole, 500, 2).known);
  EXPECT_NE(sample_voids(whole, {.remove = 500, .seed = 1}).known,
            sample_voids(whole, {.remove = 500, .seed = 2}).known);
  EXPECT_NE(sample_tracks(whole, 5, 1).known, sample_tracks(whole, 5, 2).known);
}

TEST(SampleRegular, KeepsMultiplesOfTheStep) {
  const Dem whole = ground({11, 7});
  const Dem part = sample_regular(whole, 3);
  expect_part_of(part, whole);
  EXPECT_EQ(count(part.known), 4u * 3u);
  for (int row = 0; row < 7; ++row)
    for (int col = 0; col < 11; ++col)
      EXPECT_EQ(part.known(col, row), col % 3 == 0 && row % 3 == 0);
}

TEST(SampleRegular, RefusesAStepThatLeavesNothing) {
  Dem whole = ground({3, 3});
  whole.known(0, 0) = 0;
  EXPECT_EQ(message_of([&] { sample_regular(whole, 5); }),
            "step = 5; must leave at least one known cell, and leaves none");
  EXPECT_EQ(message_of([&] { sample_regular(whole, 0); }), "step = 0; must be >= 1");
}

TEST(SampleEdges, KeepsTheSteepestCells) {
  // A cliff between columns 9 and 10: Sobel sees it in both, 20 cells of 200.
  Dem whole = plane({20, 10}, 0, 0);
  for (int row = 0; row < 10; ++row)
    for (int col = 10; col < 20; ++col) whole.z(col, row) = 100;
  const Dem part = sample_edges(whole, 20);
  for (int row = 0; row < 10; ++row)
    for (int col = 0; col < 20; ++col)
      EXPECT_EQ(part.known(col, row), col == 9 || col == 10) << col << " " << row;
}

TEST(SampleEdges, MeasuresTheGradientInMetres) {
  // 3 m a column of 100 m is flatter than 2 m a row of 10 m.
  Dem whole = plane({40, 20}, 0, 0);
  whole.spacing = {100, 10};
  for (int row = 0; row < 20; ++row)
    for (int col = 0; col < 40; ++col)
      whole.z(col, row) = col < 20 ? 3.f * float(col) : 57 + 2.f * float(row);
  const Dem part = sample_edges(whole, 18 * 20);
  for (int row = 0; row < 20; ++row)
    for (int col = 0; col < 19; ++col) EXPECT_EQ(part.known(col, row), 0) << col << " " << row;
}

TEST(SampleEdges, KeepsTheCountExactlyWhenAllAreEqual) {
  for (const std::size_t keep : {1, 17, 899, 900})
    EXPECT_EQ(count(sample_edges(plane({30, 30}, 1, 2), keep).known), keep);
}

TEST(SampleEdges, SeesNoEdgeAtTheRimOfAHole) {
  // A plane with a hole of heights that mean nothing: all gradients are equal, a hash chooses, and
  // the kept part is spread: not all of the hole's rim is in it.
  Dem whole = plane({30, 30}, 3, 4);
  for (int row = 10; row < 20; ++row)
    for (int col = 10; col < 20; ++col) {
      whole.known(col, row) = 0;
      whole.z(col, row) = -32768;
    }
  const Dem part = sample_edges(whole, 40);
  int rim = 0;
  for (int i = 9; i <= 20; ++i)
    rim += part.known(i, 9) + part.known(i, 20) + part.known(9, i) + part.known(20, i);
  EXPECT_LT(rim, 15);  // 44 cells of 800, of which 40 are kept: 2.2 are expected
}

TEST(SampleVoids, RemovesExactlyTheCountAskedFor) {
  const Dem whole = ground({300, 200}, true);
  const std::size_t known = count(whole.known);
  for (const std::size_t remove : {std::size_t(0), std::size_t(1), std::size_t(3000), known - 1}) {
    const Dem part = sample_voids(whole, {.remove = remove});
    EXPECT_EQ(count(part.known), known - remove);
    expect_part_of(part, whole);
  }
}

TEST(SampleVoids, CutsBlobsWithinTheSizesAskedFor) {
  // Voids far apart: their areas are those of discs of 5 to 20 cells across, but for the last one.
  const Dem whole = ground({1200, 1200});
  Mask known = sample_voids(whole, {.remove = 6000, .min_across = 5, .max_across = 20}).known;
  std::vector<std::size_t> areas;
  std::vector<std::pair<int, int>> open;
  for (int row = 0; row < 1200; ++row)
    for (int col = 0; col < 1200; ++col) {
      if (known(col, row)) continue;
      std::size_t area = 0;
      open.assign(1, {col, row});
      known(col, row) = 1;
      while (!open.empty()) {
        const auto [c, r] = open.back();
        open.pop_back();
        ++area;
        for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
          if (known.contains(c + dc, r + dr) && !known(c + dc, r + dr)) {
            known(c + dc, r + dr) = 1;
            open.push_back({c + dc, r + dr});
          }
      }
      areas.push_back(area);
    }
  std::ranges::sort(areas);
  EXPECT_GT(areas.size(), 40u);
  EXPECT_GE(areas[1], 19u);  // pi / 4 * 5^2 = 19.6; areas[0] may be the one cut short
  const auto large = [](std::size_t a) { return a > 315; };  // pi / 4 * 20^2 = 314.2
  EXPECT_LE(std::ranges::count_if(areas, large), 2);         // two blobs may touch
  // Logarithmic: half of them below the geometric middle, 10 across (78.5 cells).
  const auto small = double(std::ranges::count_if(areas, [](auto a) { return a < 79; }));
  EXPECT_NEAR(small / double(areas.size()), 0.5, 0.2);
}

TEST(SampleVoids, PrefersSteepGround) {
  // A twentieth of the ground is steep, the rest flat: half of the starts fall on it.
  Dem whole = plane({400, 400}, 0, 0);
  for (int row = 0; row < 400; ++row)
    for (int col = 380; col < 400; ++col) whole.z(col, row) = 50.f * float(col - 380);
  const Dem part = sample_voids(whole, {.remove = 1500, .min_across = 1, .max_across = 2});
  std::size_t on_steep = 0;
  for (int row = 0; row < 400; ++row)
    for (int col = 379; col < 400; ++col) on_steep += part.known(col, row) == 0;
  EXPECT_NEAR(double(on_steep) / 1500, 0.525, 0.06);
}

TEST(SampleVoids, RefusesToRemoveEverything) {
  const Dem whole = ground({4, 4});
  EXPECT_EQ(message_of([&] { sample_voids(whole, {.remove = 16}); }),
            "remove = 16; must be in [0, 15] for the known cells there are");
  EXPECT_EQ(message_of([&] { sample_voids(whole, {.remove = 1, .min_across = 0}); }),
            "min_across = 0; must be a whole number >= 1");
  EXPECT_EQ(
      message_of([&] { sample_voids(whole, {.remove = 1, .min_across = 9, .max_across = 8}); }),
      "max_across = 8; must be >= 9");
}

TEST(SampleTracks, RunsFromSideToSideWithoutGaps) {
  const Dem whole = ground({70, 50});
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Dem part = sample_tracks(whole, 1, seed);
    // One cell for each step along the longer axis, each a neighbour (of eight) of the one before.
    int west = 70, east = -1, north = 50, south = -1;
    for (int row = 0; row < 50; ++row)
      for (int col = 0; col < 70; ++col)
        if (part.known(col, row)) {
          west = std::min(west, col), east = std::max(east, col);
          north = std::min(north, row), south = std::max(south, row);
        }
    EXPECT_EQ(count(part.known), std::size_t(std::max(east - west, south - north)) + 1);
    EXPECT_GE((west == 0) + (east == 69) + (north == 0) + (south == 49), 2) << seed;
    for (int row = north; row <= south; ++row) {
      int in_row = 0;
      for (int col = west; col <= east; ++col) in_row += part.known(col, row);
      EXPECT_GE(in_row, 1);
    }
    for (int col = west; col <= east; ++col) {
      int in_col = 0;
      for (int row = north; row <= south; ++row) in_col += part.known(col, row);
      EXPECT_GE(in_col, 1);
    }
  }
}

TEST(SampleTracks, KeepsKnownCellsOfAnyShape) {
  for (const Size size : {Size{1, 1}, {1, 9}, {9, 1}, {2, 2}, {40, 30}}) {
    const Dem whole = ground(size);
    expect_part_of(sample_tracks(whole, 3), whole);
  }
  Dem corner = ground({3000, 3000});
  corner.known = Mask(corner.size(), 0);
  corner.known(1500, 1500) = 1;
  EXPECT_EQ(message_of([&] { sample_tracks(corner, 1); }),
            "tracks = 1; must leave at least one known cell, and leaves none");
  EXPECT_THROW(sample_tracks(corner, 0), std::invalid_argument);
}

TEST(SampleContours, KeepsTheNearerOfTwoNeighboursAndGivesItTheLevel) {
  Dem whole{Raster<float>({6, 1}), Mask({6, 1}, 1), {}, {}};
  const float heights[] = {1, 6, 9, 12, 17, 31};
  std::ranges::copy(heights, whole.z.cells().begin());
  // Level 10 lies between 9 and 12; level 20 and 30 between 17 and 31: 17 has 20, 31 has 30.
  const Dem part = sample_contours(whole, 10);
  EXPECT_THAT(part.known.cells(), testing::ElementsAre(0, 0, 1, 0, 1, 1));
  EXPECT_THAT(part.z.cells(), testing::ElementsAre(0, 0, 10, 0, 20, 30));
}

TEST(SampleContours, PassesNoLevelThroughAPlainOnOne) {
  Dem whole = plane({5, 5}, 0, 0);
  for (auto& z : whole.z.cells()) z = 20;
  EXPECT_EQ(message_of([&] { sample_contours(whole, 10); }),
            "interval_m = 10; must leave at least one known cell, and leaves none");
}

TEST(SampleContours, DrawsNothingAgainstUnknownCells) {
  Dem whole{Raster<float>({5, 1}), Mask({5, 1}, 1), {}, {}};
  const float heights[] = {1, 4, 8, 12, 16};
  std::ranges::copy(heights, whole.z.cells().begin());
  whole.known(3, 0) = 0;
  whole.known(4, 0) = 0;
  EXPECT_THROW(sample_contours(whole, 10), std::invalid_argument);
  whole.known(3, 0) = 1;
  EXPECT_EQ(count(sample_contours(whole, 10).known), 2u);  // 8 and 12 are equally near to 10
}

TEST(SampleContours, RefusesAnIntervalThatIsNone) {
  const Dem whole = ground({5, 5});
  for (const double interval : {0.0, -1.0, std::nan(""), double(INFINITY)})
    EXPECT_THROW(sample_contours(whole, interval), std::invalid_argument);
}

}  // namespace
}  // namespace dem
