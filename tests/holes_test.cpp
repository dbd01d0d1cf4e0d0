#include "dem/holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "numeric/random.h"

namespace dem {
using namespace numeric;
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
      std::vector<std::pair<int, int>> waiting{{c, r}};
      known(c, r) = 1;
      std::size_t cells = 0;
      bool rim = false;
      while (!waiting.empty()) {
        const auto [x, y] = waiting.back();
        waiting.pop_back();
        ++cells;
        rim |= x == 0 || y == 0 || x == known.cols() - 1 || y == known.rows() - 1;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx)
            if (known.contains(x + dx, y + dy) && !known(x + dx, y + dy)) {
              known(x + dx, y + dy) = 1;
              waiting.push_back({x + dx, y + dy});
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

// ---- The inventory

/// Heights that differ from cell to cell.
Dem hilly(const Mask& known, Spacing spacing = {1, 1}) {
  Dem dem{Raster<float>(known.size()), known, {}, spacing};
  for (int r = 0; r < known.rows(); ++r)
    for (int c = 0; c < known.cols(); ++c)
      dem.z(c, r) = known(c, r) ? float(50 * std::sin(c / 9.) + 30 * std::cos(r / 7.) + c) : 0;
  return dem;
}

Mask random_mask(Size size, unsigned percent_unknown, std::uint64_t seed) {
  Mask known(size);
  for (int r = 0; r < size.rows; ++r)
    for (int c = 0; c < size.cols; ++c)
      known(c, r) = below(random_bits(seed, 0, c, r), 100) >= percent_unknown;
  return known;
}

/// The greatest distance of the cells of a hole to any known cell, by trying all.
double far_by_trying(const Dem& dem, const std::vector<CellRun>& runs) {
  double greatest = 0;
  for (const CellRun& run : runs)
    for (int col = run.begin; col < run.end; ++col) {
      double least = 1e300;
      for (int r = 0; r < dem.size().rows; ++r)
        for (int c = 0; c < dem.size().cols; ++c)
          if (dem.known(c, r))
            least = std::min(
                least, std::hypot((c - col) * dem.spacing.dx_m, (r - run.row) * dem.spacing.dy_m));
      greatest = std::max(greatest, least);
    }
  return greatest;
}

TEST(FindHoles, AgreesWithFloodingAndTryingAllDistancesOnRandomMasks) {
  for (unsigned percent : {5u, 30u, 45u, 70u})
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      const Dem dem = hilly(random_mask({23, 19}, percent, seed), {3, 2});
      const auto holes = find_holes(dem);
      const auto sum = void_summary(dem.known);
      ASSERT_EQ(holes.size(), sum.voids);
      std::vector<FirstCell> first;
      for (const Hole& hole : holes) first.push_back({hole.first_col, hole.box.row});
      const auto cells = cells_of_holes(dem.known, first);
      std::size_t border = 0;
      for (std::size_t h = 0; h < holes.size(); ++h) {
        const Hole& hole = holes[h];
        std::size_t n = 0;
        int left = 99, right = 0, bottom = 0;
        for (const CellRun& run : cells[h]) {
          n += std::size_t(run.end - run.begin);
          left = std::min(left, run.begin);
          right = std::max(right, run.end);
          bottom = std::max(bottom, run.row + 1);
        }
        EXPECT_EQ(hole.cells, n);
        EXPECT_EQ(hole.box, (Box{left, cells[h][0].row, right - left, bottom - cells[h][0].row}));
        EXPECT_DOUBLE_EQ(hole.area_m2, 6. * double(n));
        EXPECT_NEAR(hole.distance_m, far_by_trying(dem, cells[h]), 1e-5);
        border += hole.at_border;
      }
      EXPECT_EQ(border, sum.border_voids);
    }
}

TEST(FindHoles, TellsTheHeightsBesideAHoleOnAllEightSides) {
  Dem dem = hilly(draw({"......",  //
                        "..#...",  //
                        "...#..",  //
                        "......"}));
  dem.z = Raster<float>({6, 4}, 100);
  dem.z(1, 0) = 90;    // touches the first cell at a corner
  dem.z(4, 3) = 130;   // the second
  dem.z(0, 0) = -999;  // touches neither
  const auto holes = find_holes(dem);
  ASSERT_EQ(holes.size(), 1u);
  EXPECT_EQ(holes[0].rim_low_m, 90);
  EXPECT_EQ(holes[0].rim_high_m, 130);
  EXPECT_EQ(holes[0].rim_relief_m(), 40);
  EXPECT_TRUE(holes[0].has_rim);
}

TEST(FindHoles, MeasuresEachRowWithItsOwnCells) {
  const Dem dem = hilly(draw({"...", ".#.", ".#.", "..."}));
  const auto holes = find_holes(dem, {{1, 10}, {2, 10}, {3, 10}, {4, 10}});
  EXPECT_DOUBLE_EQ(holes[0].area_m2, 50);
}

TEST(FindHoles, CountsMarkedCells) {
  const Dem dem = hilly(draw({".##.", ".##.", "...."}));
  Mask marked({4, 3});
  marked(2, 0) = marked(0, 1) = 1;
  EXPECT_EQ(find_holes(dem, {}, marked)[0].marked_cells, 1u);
}

TEST(FindHoles, OfAnEmptyRasterHasNoRim) {
  const auto holes = find_holes(hilly(Mask({4, 3}, 0)));
  ASSERT_EQ(holes.size(), 1u);
  EXPECT_FALSE(holes[0].has_rim);
  EXPECT_TRUE(holes[0].at_border);
}

// ---- Conditions

bool holds(const char* condition, const Hole& hole) { return parse_hole_filter(condition)(hole); }

TEST(HoleFilter, KnowsPrecedenceBracketsAndNames) {
  Hole hole;
  hole.cells = 12;
  hole.area_m2 = 3e6;
  hole.at_border = true;
  hole.rim_low_m = 10;
  hole.rim_high_m = 40;
  EXPECT_TRUE(holds("area_km2 = 3", hole));
  EXPECT_TRUE(holds("cells < 5 or cells > 9 and at_border", hole));
  EXPECT_FALSE(holds("(cells < 5 or cells > 9) and not at_border", hole));
  EXPECT_TRUE(holds("not cells < 5", hole));
  EXPECT_TRUE(holds("2 + 2*5 == cells", hole));
  EXPECT_TRUE(holds("rim_high_m - rim_low_m != -30 and rim_relief_m >= 30", hole));
  EXPECT_TRUE(holds("  -cells/4 <= -3e0 ", hole));
}

TEST(HoleFilter, SaysWhereAConditionIsWrong) {
  const auto message = [](const std::string& text) {
    try {
      parse_hole_filter(text);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message("area < 5").find("\"area < 5\""), std::string::npos);
  EXPECT_NE(message("area < 5").find("area_km2"), std::string::npos);
  EXPECT_NE(message("cells <").find("the end"), std::string::npos);
  EXPECT_NE(message("cells < 5 cells").find("an operator at \"cells\""), std::string::npos);
  EXPECT_NE(message("(cells < 5").find("closing bracket"), std::string::npos);
  EXPECT_NE(message(""), "");
  EXPECT_NE(message("nan < 5"), "");
  EXPECT_NE(message(std::string(100000, '(')), "");
  EXPECT_NE(message(std::string(100000, '-') + "1"), "");
  std::string nots;
  for (int i = 0; i < 50000; ++i) nots += "not ";
  EXPECT_NE(message(nots + "1"), "");
}

// ---- Windows

std::vector<HoleWindow> windows_of(const Dem& dem, LatticeOrigin origin = {}) {
  const auto holes = find_holes(dem);
  return plan_windows(holes, std::vector<std::uint8_t>(holes.size(), 1), dem.size(), origin);
}

void cut(Mask& known, int col, int row, int cols, int rows) {
  for (int r = row; r < row + rows; ++r) std::fill_n(&known(col, r), cols, std::uint8_t{0});
}

TEST(PlanWindows, HoldEachHoleWithAMarginThatGrowsWithIt) {
  Mask known({400, 300}, 1);
  cut(known, 20, 30, 1, 1);
  cut(known, 200, 100, 50, 40);
  const auto windows = windows_of(hilly(known));
  ASSERT_EQ(windows.size(), 2u);
  EXPECT_EQ(windows[0].box, (Box{20 - 7, 30 - 7, 15, 15}));
  EXPECT_EQ(windows[1].box, (Box{200 - 26, 100 - 26, 102, 92}));
}

TEST(PlanWindows, PutAHoleIntoTheWindowOfALargerOneThatHoldsItsOwn) {
  Mask known({400, 300}, 1);
  cut(known, 200, 100, 50, 40);
  cut(known, 185, 120, 2, 2);  // its window ends 22 cells to the left: within 26
  cut(known, 177, 140, 2, 2);  // not within, and in another square
  const auto windows = windows_of(hilly(known));
  ASSERT_EQ(windows.size(), 2u);
  EXPECT_EQ(windows[0].holes.size(), 2u);
}

TEST(PlanWindows, LeaveOutHolesThatAreNotChosen) {
  Mask known({60, 60}, 1);
  cut(known, 10, 10, 2, 2);
  cut(known, 40, 40, 2, 2);
  const auto holes = find_holes(hilly(known));
  const auto windows = plan_windows(holes, {0, 1}, known.size());
  ASSERT_EQ(windows.size(), 1u);
  EXPECT_EQ(windows[0].holes, std::vector<std::uint32_t>{1});
}

// ---- Filling

/// A method that looks at all of its window: each unknown cell becomes the mean of the window's
/// known cells plus a part of its place in the window.
Filled mean_fill(const Dem& dem, const Run&) {
  double sum = 0;
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i) sum += dem.z.cells()[i];
  Filled filled{dem.z, Raster<float>(dem.size()), {}};
  for (int r = 0; r < dem.size().rows; ++r)
    for (int c = 0; c < dem.size().cols; ++c)
      if (!dem.known(c, r))
        filled.z(c, r) = float(sum / double(count(dem.known)) + 0.01 * c + 0.001 * r);
  return filled;
}

HoleWork work_on(const Dem& dem) {
  HoleWork work;
  work.read = [&dem](const Box& box) { return WindowData{crop(dem, box, dem.spacing), {}, {}}; };
  work.fill = mean_fill;
  return work;
}

/// The DEM with the holes of the windows filled, cell by cell in the raster.
Dem filled_by(const Dem& dem, HoleWork work, const std::vector<Hole>& holes,
              const std::vector<HoleWindow>& windows, int threads = 1) {
  Dem out = dem;
  work.take = [&out](HolePatch&& patch) {
    std::size_t i = 0;
    for (const CellRun& run : patch.runs)
      for (int col = run.begin; col < run.end; ++col, ++i) {
        out.z(col, run.row) = patch.z[i];
        out.known(col, run.row) = 1;
      }
  };
  fill_windows(holes, windows, work, {threads, {}});
  return out;
}

Dem filled(const Dem& dem, LatticeOrigin origin = {}, int threads = 1,
           std::size_t memory_cells = std::size_t(-1)) {
  const auto holes = find_holes(dem);
  HoleWork work = work_on(dem);
  work.memory_cells = memory_cells;
  return filled_by(
      dem, work, holes,
      plan_windows(holes, std::vector<std::uint8_t>(holes.size(), 1), dem.size(), origin), threads);
}

/// A raster with holes of all sizes, some at its border.
Dem holed() {
  Mask known = random_mask({300, 260}, 1, 7);
  cut(known, 100, 60, 50, 40);
  cut(known, 0, 200, 20, 30);
  cut(known, 200, 100, 4, 70);
  cut(known, 155, 80, 3, 3);
  return hilly(known);
}

TEST(FillWindows, FillsEveryCellAndKeepsTheKnownOnes) {
  const Dem dem = holed();
  const Dem got = filled(dem);
  EXPECT_EQ(count(got.known), dem.size().cells());
  Dem known_only = got;
  known_only.known = dem.known;
  EXPECT_EQ(known_checksum(known_only), known_checksum(dem));
}

TEST(FillWindows, IsTheSameForAnyThreadsAndMemory) {
  const Dem dem = holed(), one = filled(dem);
  EXPECT_EQ(filled(dem, {}, 2).z, one.z);
  EXPECT_EQ(filled(dem, {}, 2, 1).z, one.z);
}

TEST(FillWindows, IsTheSameInACutOfTheRasterThatHoldsTheWindows) {
  const Dem dem = holed(), whole = filled(dem);
  const Box box{17, 33, 250, 200};
  const Dem part = filled(crop(dem, box, dem.spacing), {box.col, box.row});
  const auto holes = find_holes(dem);
  std::size_t compared = 0;
  for (const HoleWindow& w :
       plan_windows(holes, std::vector<std::uint8_t>(holes.size(), 1), dem.size())) {
    if (!(w.box.col > box.col && w.box.row > box.row && w.box.col + w.box.cols < 267 &&
          w.box.row + w.box.rows < 233))
      continue;
    for (const std::uint32_t h : w.holes) {
      ++compared;
      const Hole& hole = holes[h];
      EXPECT_EQ(part.z(hole.first_col - box.col, hole.box.row - box.row),
                whole.z(hole.first_col, hole.box.row));
    }
  }
  EXPECT_GT(compared, 100u);
}

TEST(FillWindows, StopsWhenAskedTo) {
  const Dem dem = holed();
  const auto holes = find_holes(dem);
  const auto windows = plan_windows(holes, std::vector<std::uint8_t>(holes.size(), 1), dem.size());
  HoleWork work = work_on(dem);
  work.take = [](HolePatch&&) {};
  EXPECT_THROW(fill_windows(holes, windows, work, {1, [](double, auto) { return false; }}),
               Cancelled);
}

TEST(FillWindows, LaysAHoleWithAFlatRimFlat) {
  Mask known({60, 60}, 1);
  cut(known, 20, 20, 5, 5);
  cut(known, 40, 40, 5, 5);
  Dem dem = hilly(known);
  for (int r = 18; r < 27; ++r) std::fill_n(&dem.z(18, r), 9, 77.f);
  const auto holes = find_holes(dem);
  HoleWork work = work_on(dem);
  work.flat_water = true;
  const Dem got = filled_by(dem, work, holes, plan_windows(holes, {1, 1}, dem.size()));
  for (int r = 20; r < 25; ++r)
    for (int c = 20; c < 25; ++c) EXPECT_EQ(got.z(c, r), 77);
  EXPECT_NE(got.z(41, 41), got.z(42, 42));
}

TEST(FillWindows, LaysWaterFlatAndKeepsItsShoreAbove) {
  Mask known({60, 60}, 1);
  cut(known, 20, 20, 20, 20);
  Dem dem = hilly(known);
  for (float& z : dem.z.cells()) z = 10;
  for (int c = 0; c < 60; ++c) dem.z(c, 40) = 50;  // the lake reaches the rim here
  const auto holes = find_holes(dem);
  HoleWork work = work_on(dem);
  Mask water(dem.size());
  for (int r = 30; r < 60; ++r) std::fill_n(&water(25, r), 10, std::uint8_t{1});
  work.read = [&](const Box& box) {
    WindowData data{crop(dem, box, dem.spacing), {}, Mask(box.size())};
    for (int r = 0; r < box.rows; ++r)
      for (int c = 0; c < box.cols; ++c) data.water(c, r) = water(box.col + c, box.row + r);
    return data;
  };
  const Dem got = filled_by(dem, work, holes, plan_windows(holes, {1}, dem.size()));
  for (int r = 30; r < 40; ++r)
    for (int c = 25; c < 35; ++c) EXPECT_EQ(got.z(c, r), 50);
  EXPECT_GE(got.z(24, 35), 50);  // its shore
  EXPECT_LT(got.z(22, 22), 30);  // far from it
}

TEST(FillWindows, TakesTheGuideThatFindsTheRimBestAndRemovesItsOffset) {
  Mask known({80, 80}, 1);
  cut(known, 30, 30, 15, 15);
  const Dem truth = hilly(Mask({80, 80}, 1));
  Dem dem = truth;
  dem.known = known;
  Dem good = truth, bad = truth;
  for (float& z : good.z.cells()) z += 40;
  for (std::size_t i = 0; i < bad.z.cells().size(); ++i) bad.z.cells()[i] *= -1;
  const auto holes = find_holes(dem);
  HoleWork work = work_on(dem);
  work.read = [&](const Box& box) {
    return WindowData{crop(dem, box, dem.spacing),
                      {crop(bad, box, dem.spacing), crop(good, box, dem.spacing)},
                      {}};
  };
  work.fill = [](const Dem& d, const dem::Run& run) {
    Filled f = mean_fill(d, run);  // flat: the place in the window would be an error of its own
    for (int r = 0; r < d.size().rows; ++r)
      for (int c = 0; c < d.size().cols; ++c)
        if (!d.known(c, r)) f.z(c, r) -= float(0.01 * c + 0.001 * r);
    return f;
  };
  Dem out = dem;
  work.take = [&](HolePatch&& patch) {
    EXPECT_EQ(patch.guide, std::vector<int>{1});
    EXPECT_NEAR(patch.offset_m[0], -40, 1e-3);
    EXPECT_EQ(patch.origin[0], CellOrigin::guide);
    std::size_t i = 0;
    for (const CellRun& run : patch.runs)
      for (int col = run.begin; col < run.end; ++col, ++i)
        EXPECT_NEAR(patch.z[i], truth.z(col, run.row), 0.02);
  };
  fill_windows(holes, plan_windows(holes, {1}, dem.size()), work);
}

TEST(KnownChecksum, ChangesWithAnyKnownCellAndWithNoUnknownOne) {
  Dem dem = hilly(random_mask({20, 20}, 30, 1));
  const auto before = known_checksum(dem);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i) {
    float& z = dem.z.cells()[i];
    const float old = z;
    z = std::nextafter(z, 1e9f);
    EXPECT_EQ(known_checksum(dem) != before, dem.known.cells()[i] != 0);
    seen += dem.known.cells()[i];
    z = old;
  }
  EXPECT_GT(seen, 100u);
}

}  // namespace
}  // namespace dem
