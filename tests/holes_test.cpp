#include "dem/holes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "random.h"

namespace dem {
namespace {

/// A mask from a drawing: '#' is unknown.
Mask draw(const std::vector<std::string>& rows) {
  Mask known({int(rows[0].size()), int(rows.size())}, 1);
  for (int r = 0; r < known.rows(); ++r)
    for (int c = 0; c < known.cols(); ++c)
      known(c, r) = rows[std::size_t(r)][std::size_t(c)] != '#';
  return known;
}

/// The same numbers by flooding from cell to cell.
VoidSummary flood(Mask known) {
  VoidSummary sum;
  for (int r = 0; r < known.rows(); ++r)
    for (int c = 0; c < known.cols(); ++c) {
      if (known(c, r)) continue;
      std::vector<std::pair<int, int>> todo{{c, r}};
      known(c, r) = 1;
      std::size_t cells = 0;
      bool rim = false;
      while (!todo.empty()) {
        const auto [x, y] = todo.back();
        todo.pop_back();
        ++cells;
        rim |= x == 0 || y == 0 || x == known.cols() - 1 || y == known.rows() - 1;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx)
            if (known.contains(x + dx, y + dy) && !known(x + dx, y + dy)) {
              known(x + dx, y + dy) = 1;
              todo.push_back({x + dx, y + dy});
            }
      }
      ++sum.voids;
      sum.cells += cells;
      sum.largest = std::max(sum.largest, cells);
      sum.border_voids += rim;
      if (rim) sum.border_cells += cells;
    }
  return sum;
}

TEST(VoidSummary, OfAWholeRasterIsZero) {
  const auto sum = void_summary(Mask({4, 3}, 1));
  EXPECT_EQ(sum.cells, 0u);
  EXPECT_EQ(sum.voids, 0u);
  EXPECT_EQ(sum.largest, 0u);
}

TEST(VoidSummary, OfAnEmptyRasterIsOneVoidOnTheBorder) {
  const auto sum = void_summary(Mask({4, 3}, 0));
  EXPECT_EQ(sum.voids, 1u);
  EXPECT_EQ(sum.largest, 12u);
  EXPECT_EQ(sum.border_cells, 12u);
}

TEST(VoidSummary, JoinsCellsThatTouchAtACorner) {
  const auto sum = void_summary(draw({".....",  //
                                      ".#.#.",  //
                                      "..#..",  //
                                      "....."}));
  EXPECT_EQ(sum.voids, 1u);
  EXPECT_EQ(sum.cells, 3u);
  EXPECT_EQ(sum.border_voids, 0u);
}

TEST(VoidSummary, JoinsArmsThatMeetOnlyFurtherDown) {
  const auto sum = void_summary(draw({".......",  //
                                      ".#.#.#.",  //
                                      ".#.#.#.",  //
                                      ".#####.",  //
                                      "......."}));
  EXPECT_EQ(sum.voids, 1u);
  EXPECT_EQ(sum.largest, 11u);
}

TEST(VoidSummary, TellsVoidsOnTheBorderFromInnerOnes) {
  const auto sum = void_summary(draw({"#....#",  //
                                      "..#...",  //
                                      "......",  //
                                      "##...."}));
  EXPECT_EQ(sum.voids, 4u);
  EXPECT_EQ(sum.border_voids, 3u);
  EXPECT_EQ(sum.border_cells, 4u);
  EXPECT_EQ(sum.largest, 2u);
}

TEST(VoidSummary, AgreesWithFloodingOnRandomMasks) {
  for (int percent : {5, 30, 45, 60, 90})
    for (int seed = 0; seed < 20; ++seed) {
      Mask known({1 + seed, 21});
      for (int r = 0; r < known.rows(); ++r)
        for (int c = 0; c < known.cols(); ++c)
          known(c, r) = below(random_bits(std::uint64_t(seed), 0, c, r), 100) >= unsigned(percent);
      const auto got = void_summary(known), want = flood(known);
      EXPECT_EQ(got.cells, want.cells);
      EXPECT_EQ(got.voids, want.voids);
      EXPECT_EQ(got.largest, want.largest);
      EXPECT_EQ(got.border_voids, want.border_voids);
      EXPECT_EQ(got.border_cells, want.border_cells);
    }
}

TEST(InnerVoids, MarksTheCellsOfVoidsOffTheBorderOnly) {
  const auto inner = inner_voids(draw({"##...",  //
                                       "..#..",  //
                                       ".....",  //
                                       ".#.#.",  //
                                       "....."}));
  EXPECT_EQ(count(inner), 2u);
  EXPECT_EQ(inner(1, 3), 1);
  EXPECT_EQ(inner(3, 3), 1);
  EXPECT_EQ(inner(2, 1), 0);  // touches (1, 0) at a corner, which lies on the border
}

}  // namespace
}  // namespace dem
