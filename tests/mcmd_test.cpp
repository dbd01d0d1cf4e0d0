#include "dem/mcmd.h"

#include <gmock/gmock.h>

#include <cmath>
#include <deque>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>

#include "dem/evaluate.h"
#include "midpoint/lattice.h"
#include "numeric/random.h"

namespace dem {
using namespace midpoint;
using namespace numeric;
namespace {

using ::testing::FloatEq;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::ThrowsMessage;

/// A DEM of rolling heights around 0 m, a share `kept` of its cells known.
Dem rolling(Size size, double kept, std::uint64_t seed = 1) {
  Dem dem{Raster<float>(size), Mask(size), {}, {}};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      dem.z(col, row) = float(80 * std::sin(col * 0.31) + 50 * std::cos(row * 0.17 + col * 0.05));
      const double u = (signed_uniform(random_bits(seed, 77, col, row)) + 1) / 2;
      dem.known(col, row) = u < kept;
    }
  dem.known(size.cols / 2, size.rows / 2) = 1;
  return dem;
}

Raster<float> raster(Size size, std::vector<float> cells) {
  Raster<float> r(size);
  std::ranges::copy(cells, r.cells().begin());
  return r;
}

// ---- The lattice

TEST(Lattice, ChildrenAreTheInverseOfAscendantsInEverySize) {
  for (auto how : {Subdivision::triangle_edge, Subdivision::diamond_square})
    for (int cols = 1; cols <= 20; ++cols)
      for (int rows : {1, 2, 3, 5, 6, 8, 9, 12, 17}) {
        const Lattice lattice({cols, rows}, how);
        std::multiset<std::array<int, 4>> up, down;
        for (int row = 0; row < rows; ++row)
          for (int col = 0; col < cols; ++col) {
            lattice.for_each_ascendant(col, row, [&](int c, int r) {
              up.insert({c, r, col, row});
            });
            lattice.for_each_child(col, row, [&](int c, int r) { down.insert({col, row, c, r}); });
          }
        EXPECT_EQ(up, down) << cols << " x " << rows;
      }
}

TEST(Lattice, EveryCellButTheRootsHasAscendantsInsideTheRaster) {
  for (Size size : {Size{403, 344}, Size{1, 40}, Size{33, 17}, Size{6, 100}}) {
    const Lattice lattice(size, Subdivision::diamond_square);
    const Raster<float> raster(size);
    for (int row = 0; row < size.rows; ++row)
      for (int col = 0; col < size.cols; ++col) {
        int n = 0;
        lattice.for_each_ascendant(col, row, [&](int c, int r) {
          ++n;
          EXPECT_TRUE(raster.contains(c, r));
        });
        const bool root = (col == 0 || col == size.cols - 1) && (row == 0 || row == size.rows - 1);
        EXPECT_EQ(n == 0, root) << col << ", " << row;
      }
  }
}

// ---- Oracles: the definitions, cell by cell, with no thought of speed

/// Algorithm 1 of [belhadj2007] to the letter: a FIFO queue and a hash table of children.
Dem oracle_waves(const Dem& dem, Subdivision how, double I_bu) {
  struct Cell {
    int col, row;
  };
  const Lattice lattice(dem.size(), how);
  const double d_max = std::hypot(dem.z.cols(), dem.z.rows());
  Dem e = dem;
  std::deque<Cell> queue;
  for (int row = 0; row < dem.z.rows(); ++row)
    for (int col = 0; col < dem.z.cols(); ++col)
      if (dem.known(col, row)) queue.push_back({col, row});
  while (!queue.empty()) {
    std::unordered_map<int, std::vector<Cell>> table;
    while (!queue.empty()) {
      const Cell child = queue.front();
      queue.pop_front();
      lattice.for_each_ascendant(child.col, child.row, [&](int col, int row) {
        if (!e.known(col, row)) table[row * dem.z.cols() + col].push_back(child);
      });
    }
    for (const auto& [index, children] : table) {
      const int col = index % dem.z.cols(), row = index / dem.z.cols();
      double sum = 0;
      for (const Cell& c : children) {
        const double d = std::hypot(c.col - col, c.row - row);
        const double sigma = I_bu >= 0 ? 1 : -1;
        sum += e.z(c.col, c.row) *
               (1 - sigma * (1 - std::pow(1 - d / d_max, std::abs(I_bu))));  // equation 3
      }
      e.z(col, row) = float(sum / double(children.size()));
    }
    for (const auto& entry : table) {
      const int col = entry.first % dem.z.cols(), row = entry.first / dem.z.cols();
      e.known(col, row) = 1;
      queue.push_back({col, row});
    }
  }
  return e;
}

int birth(const Lattice& lattice, int col, int row) {
  return std::min(lattice.x.stride(col), lattice.y.stride(row));
}
bool is_centre(const Lattice& lattice, int col, int row) {
  return lattice.x.stride(col) == lattice.y.stride(row);
}

/// Bottom-up by levels: stride by stride, edges before centres, roots last.
Dem oracle_levels(const Dem& dem, Subdivision how, double I_bu, double p) {
  const Lattice lattice(dem.size(), how);
  const double d_max = std::hypot(dem.z.cols(), dem.z.rows());
  Dem e = dem;
  const auto settle = [&](int col, int row) {
    double sum = 0, weights = 0;
    lattice.for_each_child(col, row, [&](int c, int r) {
      if (!e.known(c, r)) return;
      const double d = std::hypot(c - col, r - row), w = std::pow(d, -p);
      const double sigma = I_bu >= 0 ? 1 : -1;
      sum += w * e.z(c, r) * (1 - sigma * (1 - std::pow(1 - d / d_max, std::abs(I_bu))));
      weights += w;
    });
    if (weights > 0) e.z(col, row) = float(sum / weights), e.known(col, row) = 1;
  };
  const auto stage = [&](int s, bool centres) {
    for (int row = 0; row < dem.z.rows(); ++row)
      for (int col = 0; col < dem.z.cols(); ++col)
        if (birth(lattice, col, row) == s && is_centre(lattice, col, row) == centres &&
            !e.known(col, row))
          settle(col, row);
  };
  for (int s = 1; s <= lattice.top_stride(); s *= 2) stage(s, false), stage(s, true);
  stage(Axis::infinite, true);
  return e;
}

/// Top-down with equation 2 and no noise, from known corners.
Raster<float> oracle_displace(const Dem& dem, Subdivision how, double I) {
  const Lattice lattice(dem.size(), how);
  const double d_max = std::hypot(dem.z.cols(), dem.z.rows());
  Raster<float> z = dem.z;
  for (int s = Axis::infinite; s >= 1; s = s == Axis::infinite ? lattice.top_stride() : s / 2)
    for (bool centres : {true, false})
      for (int row = 0; row < dem.z.rows(); ++row)
        for (int col = 0; col < dem.z.cols(); ++col) {
          if (birth(lattice, col, row) != s || is_centre(lattice, col, row) != centres) continue;
          if (dem.known(col, row)) continue;
          double sum = 0;
          int n = 0;
          lattice.for_each_ascendant(col, row, [&](int c, int r) {
            const double d = std::hypot(c - col, r - row), sigma = I >= 0 ? 1 : -1;
            sum += z(c, r) * (1 - sigma * (1 - std::pow(1 - d / d_max, std::abs(I))));
            ++n;
          });
          z(col, row) = n ? float(sum / n) : 0;
        }
  return z;
}

/// Corners that nothing rose to take the mean of the others.
Dem with_roots(Dem dem) {
  std::set<std::pair<int, int>> known, unknown;
  for (int col : {0, dem.z.cols() - 1})
    for (int row : {0, dem.z.rows() - 1})
      (dem.known(col, row) ? known : unknown).insert({col, row});
  double sum = 0;
  for (auto [col, row] : known) sum += dem.z(col, row) / double(known.size());
  for (auto [col, row] : unknown) dem.z(col, row) = float(sum), dem.known(col, row) = 1;
  return dem;
}

void expect_near(const Raster<float>& a, const Raster<float>& b, double tolerance,
                 const std::string& what) {
  ASSERT_EQ(a.size(), b.size());
  for (int row = 0; row < a.rows(); ++row)
    for (int col = 0; col < a.cols(); ++col)
      ASSERT_NEAR(a(col, row), b(col, row), tolerance) << what << " at " << col << ", " << row;
}

const std::vector<Size> sizes{{1, 1},  {2, 1},  {1, 2},   {2, 2},   {3, 3},   {5, 4},
                              {4, 7},  {9, 9},  {17, 33}, {64, 31}, {40, 57}, {1, 37},
                              {37, 1}, {2, 50}, {6, 6},   {130, 12}};

TEST(FillMcmd, WavesEqualTheLiteralAlgorithm) {
  for (Size size : sizes)
    for (auto how : {Subdivision::triangle_edge, Subdivision::diamond_square})
      for (double I_bu : {0.0, 2.5, -0.7}) {
        const Dem dem = rolling(size, 0.1);
        const Dem got = carry_up_mcmd(
            dem, {.subdivision = how, .order = UpOrder::waves, .weight_exponent = 0, .I_bu = I_bu});
        const Dem want = oracle_waves(dem, how, I_bu);
        ASSERT_EQ(got.known, want.known) << size.cols << " x " << size.rows;
        for (std::size_t i = 0; i < size.cells(); ++i)
          if (want.known.cells()[i]) {  // float32 sums of heights up to 130 m
            ASSERT_NEAR(got.z.cells()[i], want.z.cells()[i], 1e-3);
          }
      }
}

TEST(FillMcmd, LevelsEqualTheDefinitionCellByCell) {
  for (Size size : sizes)
    for (auto how : {Subdivision::triangle_edge, Subdivision::diamond_square})
      for (double kept : {0.02, 0.3, 0.9})
        for (double bend : {0.0, 3.0, -0.6}) {
          const Dem dem = rolling(size, kept);
          const McmdOptions options{.subdivision = how, .I = bend / 2, .I_bu = bend};
          const Dem want = oracle_levels(dem, how, bend, options.weight_exponent);
          const Dem got = carry_up_mcmd(dem, options);
          const auto what = std::to_string(size.cols) + " x " + std::to_string(size.rows);
          ASSERT_EQ(got.known, want.known) << what;
          for (std::size_t i = 0; i < size.cells(); ++i)
            if (want.known.cells()[i]) {
              ASSERT_NEAR(got.z.cells()[i], want.z.cells()[i], 2e-3) << what;
            }
          expect_near(fill_mcmd(dem, options), oracle_displace(with_roots(want), how, bend / 2),
                      2e-3, what);
        }
}

TEST(FillMd, EqualsTheDefinitionCellByCell) {
  for (Size size : sizes)
    for (auto how : {Subdivision::triangle_edge, Subdivision::diamond_square}) {
      const Dem dem = rolling(size, 0.2);
      expect_near(fill_md(dem, {.subdivision = how, .I = 1.5}), oracle_displace(dem, how, 1.5),
                  2e-3, std::to_string(size.cols) + " x " + std::to_string(size.rows));
    }
}

// ---- Worked by hand
//
// A 5 x 5 lattice, triangle-edge, waves, plain means: figure 7's situation, two constraints.
//
//   known            wave 1 (ascendants of both)      wave 2 (ascendants of wave 1)
//   .  .  .  .  .    10  .  10  .  .                  10  .  10  .  15
//   . 10  .  .  .     . 10   .  .  .                   . 10   .  .   .
//   .  .  . 20  .    10  .  15 20 20                  10  .  15 20  20
//   .  .  .  .  .     .  .   .  .  .                   .  .   .  .   .
//   .  .  .  .  .     .  .   .  .  .                 12.5 .   .  . 17.5
//
// (1,1) is a centre: it pushes 10 to (0,0), (2,0), (0,2), (2,2). (3,2) is an edge: it pushes 20 to
// (2,2) and (4,2). So (2,2) = (10 + 20) / 2 = 15.
// Then (2,0) pushes 10 to (4,0); (0,2) pushes 10 to (0,4); (2,2), the centre of the whole, pushes
// 15 to (4,0), (0,4), (4,4); (4,2) pushes 20 to (4,0), (4,4). So (4,0) = (10 + 15 + 20) / 3 = 15,
// (0,4) = (10 + 15) / 2 = 12.5, (4,4) = (15 + 20) / 2 = 17.5. Roots have no ascendants: the end.
// Ten constraints instead of two, as the paper says.
TEST(FillMcmd, FiveByFiveWorkedByHand) {
  Dem dem{Raster<float>(Size{5, 5}), Mask(Size{5, 5}), {}, {}};
  dem.z(1, 1) = 10, dem.known(1, 1) = 1;
  dem.z(3, 2) = 20, dem.known(3, 2) = 1;
  const McmdOptions paper{
      .subdivision = Subdivision::triangle_edge, .order = UpOrder::waves, .weight_exponent = 0};

  const Dem up = carry_up_mcmd(dem, paper);
  EXPECT_EQ(count(up.known), 10u);
  const std::map<std::pair<int, int>, float> want{
      {{0, 0}, 10.f}, {{2, 0}, 10.f}, {{0, 2}, 10.f}, {{2, 2}, 15.f},  {{4, 2}, 20.f},
      {{1, 1}, 10.f}, {{3, 2}, 20.f}, {{4, 0}, 15.f}, {{0, 4}, 12.5f}, {{4, 4}, 17.5f}};
  for (const auto& [cell, z] : want) {
    EXPECT_EQ(up.known(cell.first, cell.second), 1);
    EXPECT_FLOAT_EQ(up.z(cell.first, cell.second), z);
  }

  // Top-down: (2,4) = (12.5 + 17.5) / 2; centres from four corners; edges from two ends.
  const Raster<float> all = raster({5, 5}, {10,    10,     10,   12.5,   15,     //
                                            10,    10,     12.5, 15,     17.5,   //
                                            10,    12.5,   15,   20,     20,     //
                                            11.25, 13.125, 15,   16.875, 18.75,  //
                                            12.5,  13.75,  15,   16.25,  17.5});
  const auto filled = fill_mcmd(dem, paper);
  EXPECT_THAT(filled.cells(), Pointwise(FloatEq(), all.cells()));
}

// ---- Claims

TEST(FillMcmd, MirroredInputGivesMirroredOutputBitForBit) {
  const Size size{65, 33};
  const Dem dem = rolling(size, 0.15);
  Dem mirrored = dem;
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      mirrored.z(col, row) = dem.z(size.cols - 1 - col, size.rows - 1 - row);
      mirrored.known(col, row) = dem.known(size.cols - 1 - col, size.rows - 1 - row);
    }
  for (auto how : {Subdivision::triangle_edge, Subdivision::diamond_square}) {
    const auto a = fill_mcmd(dem, {.subdivision = how});
    const auto b = fill_mcmd(mirrored, {.subdivision = how});
    for (int row = 0; row < size.rows; ++row)
      for (int col = 0; col < size.cols; ++col)
        ASSERT_EQ(a(col, row), b(size.cols - 1 - col, size.rows - 1 - row)) << col << ", " << row;
  }
}

TEST(FillMcmd, OneKnownCellFillsEverySize) {
  for (Size size : sizes) {
    Dem dem{Raster<float>(size), Mask(size), {}, {}};
    dem.z(size.cols / 2, size.rows / 3) = -12.5f;
    dem.known(size.cols / 2, size.rows / 3) = 1;
    for (auto order : {UpOrder::waves, UpOrder::levels}) {
      const auto filled = fill_mcmd(dem, {.order = order});
      for (float z : filled.cells()) ASSERT_EQ(z, -12.5f);
    }
  }
}

TEST(FillMcmd, WorksAtTheSizesOfSrtmTiles) {
  for (Size size : {Size{1201, 1201}, Size{3601, 3601}}) {
    const Dem dem = rolling(size, 0.05);
    const auto z = fill_mcmd(dem);
    for (float v : z.cells()) ASSERT_TRUE(std::abs(v) <= 130);  // means stay within the data
  }
}

TEST(FillMcmd, BendsActRelativeToTheDatum) {
  Dem low = rolling({33, 33}, 0.05), high = low;
  for (float& z : high.z.cells()) z += 1000;
  const auto a = fill_mcmd(low, {.I = 2, .I_bu = 4});
  const auto b = fill_mcmd(high, {.I = 2, .I_bu = 4, .datum_m = 1000});
  for (std::size_t i = 0; i < a.cells().size(); ++i)
    ASSERT_NEAR(a.cells()[i] + 1000, b.cells()[i], 1e-3);
}

TEST(FillMcmd, PositiveBendsFallAndNegativeOnesRiseAwayFromAPeak) {
  Dem dem{Raster<float>(Size{65, 65}), Mask(Size{65, 65}), {}, {}};
  dem.z(32, 32) = 100, dem.known(32, 32) = 1;
  const auto fall = fill_mcmd(dem, {.I = 2, .I_bu = 2});
  const auto flat = fill_mcmd(dem);
  const auto rise = fill_mcmd(dem, {.I = -2, .I_bu = -2});
  EXPECT_LT(fall(5, 5), flat(5, 5));
  EXPECT_GT(rise(5, 5), flat(5, 5));
}

TEST(FillMcmd, RidgesAndRiversBendByTheirOwnExponents) {
  Dem dem{Raster<float>(Size{33, 33}), Mask(Size{33, 33}), {}, {}};
  Raster<CellKind> kinds(dem.size(), CellKind::plain);
  for (int row = 0; row < 33; ++row) {
    dem.z(8, row) = 50, dem.known(8, row) = 1, kinds(8, row) = CellKind::ridge;
    dem.z(24, row) = 50, dem.known(24, row) = 1, kinds(24, row) = CellKind::river;
  }
  for (auto order : {UpOrder::levels, UpOrder::waves}) {
    const McmdOptions options{
        .order = order, .I_ridge = 3, .I_bu_ridge = 3, .I_river = -1, .I_bu_river = -1};
    const auto z = fill_mcmd(dem, options, {}, kinds);
    EXPECT_LT(z(6, 15), 50) << "beside the ridge";
    EXPECT_GT(z(27, 15), 50) << "beside the river";
    const auto plain = fill_mcmd(dem, options);
    EXPECT_EQ(plain(6, 15), 50) << "no kinds, no bends";
  }
}

TEST(FillMcmd, NoiseFollowsEquationOne) {
  // Displacement of a node = value - mean of its ascendants. At stride s of the root's S it is
  // (u + rt) * rs * 2^(-2 r H) * d with r = log2(S / s): its standard deviation falls by
  // 2^(1 + 2 H) from level to level, its mean is rt / std(u) of that.
  const Size size{513, 513};
  const Dem empty{Raster<float>(size), Mask(size), {}, {}};
  for (double H : {-0.25, 0.2, 0.5})
    for (auto how : {Subdivision::triangle_edge, Subdivision::diamond_square}) {
      const auto z = fill_md(empty, {.subdivision = how, .H = H, .rt = 0.5, .rs = 3, .seed = 11});
      const Lattice lattice(size, how);
      std::map<int, std::vector<double>> displacements;  // by stride, for a distance of one cell
      for (int row = 0; row < size.rows; ++row)
        for (int col = 0; col < size.cols; ++col) {
          double sum = 0, d = 0;
          int n = 0;
          lattice.for_each_ascendant(col, row, [&](int c, int r) {
            sum += z(c, r), d += std::hypot(c - col, r - row), ++n;
          });
          if (n)
            displacements[birth(lattice, col, row)].push_back((z(col, row) - sum / n) / (d / n));
        }
      for (int s = 1; s <= 16; s *= 2) {
        const auto& all = displacements[s];
        const double mean = std::accumulate(all.begin(), all.end(), 0.0) / double(all.size());
        double square = 0;
        for (double v : all) square += (v - mean) * (v - mean);
        const double scale = 3 * std::exp2(-2 * H * std::log2(256.0 / s));
        const double deviation = scale / std::sqrt(3.0);  // of a uniform in [-1, 1]
        const double n = double(all.size());
        // 5 standard errors; of float32 heights, at the finest levels, some more
        const double rounding = 3e-4;
        EXPECT_NEAR(std::sqrt(square / n), deviation, 5 * deviation / std::sqrt(2 * n) + rounding);
        EXPECT_NEAR(mean, 0.5 * scale, 5 * deviation / std::sqrt(n) + rounding);
      }
    }
}

TEST(FillMd, TheSpectrumOfAFractalFollowsH) {
  // Noise that falls as 2^-h a level, h = 1 + 2 H, makes a surface of Hurst exponent h for
  // 0 < h < 1: a power spectrum of slope 2 + 2 h. Midpoint displacement is known to be rough on it
  // (creases add power at short waves), so the tolerance is wide, but the order must hold.
  const Size size{513, 513};
  const Dem empty{Raster<float>(size), Mask(size), {}, {}};
  double before = 0;
  for (double H : {-0.4, -0.25, -0.1}) {
    double slope = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const auto z = fill_md(empty, {.H = H, .rs = 1, .seed = seed});
      slope += spectral_slope(power_spectrum(z, {1, 1}), 6, 100) / 4;
    }
    EXPECT_NEAR(slope, 2 + 2 * (1 + 2 * H), 0.4) << "H = " << H;
    EXPECT_GT(slope, before + 0.2);
    before = slope;
  }
}

TEST(FillMdi, ItsNoiseIsTheMeanDistanceTimesTheScale) {
  // One known centre of the finest stride: each corner of its square has one child, sqrt 2 away.
  Dem dem{Raster<float>(Size{9, 9}), Mask(Size{9, 9}), {}, {}};
  dem.z(3, 3) = 100, dem.known(3, 3) = 1;
  const Dem still = carry_up_mdi(dem, {.rs_bu = 0});
  EXPECT_EQ(still.z(2, 2), 100);
  double largest = 0, sum = 0;
  const int seeds = 2000;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const double noise = carry_up_mdi(dem, {.rs_bu = 5, .seed = seed}).z(2, 2) - 100;
    largest = std::max(largest, std::abs(noise));
    sum += noise;
  }
  EXPECT_LE(largest, 5 * std::sqrt(2.0) + 1e-4);
  EXPECT_GT(largest, 0.99 * 5 * std::sqrt(2.0));
  EXPECT_NEAR(sum / seeds, 0, 5 * 5 * std::sqrt(2.0 / 3) / std::sqrt(double(seeds)));
}

TEST(FillMdi, WithoutNoiseIsThePapersMcmdWithoutBends) {
  const Dem dem = rolling({40, 57}, 0.1);
  const auto mdi = fill_mdi(dem, {.rs_bu = 0});
  const auto mcmd = fill_mcmd(
      dem,
      {.subdivision = Subdivision::triangle_edge, .order = UpOrder::waves, .weight_exponent = 0});
  EXPECT_EQ(mdi, mcmd);
}

TEST(FillMd, ADemWithoutAnyKnownCellStartsFromTheDatum) {
  const Dem empty{Raster<float>(Size{9, 9}), Mask(Size{9, 9}), {}, {}};
  const auto filled = fill_md(empty, {.datum_m = 321});
  for (float z : filled.cells()) EXPECT_EQ(z, 321);
}

TEST(FillMcmd, MisuseNamesTheFieldTheValueAndTheConstraint) {
  const Dem dem = rolling({5, 5}, 0.5);
  EXPECT_THAT(
      [&] { fill_mcmd(dem, {.weight_exponent = -1}); },
      ThrowsMessage<std::invalid_argument>("weight_exponent = -1; must be a number in [0, 16]"));
  EXPECT_THAT([&] { fill_mcmd(dem, {.H = std::nan("")}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("H = nan; must be")));
  const Dem unknown{Raster<float>(Size{5, 5}), Mask(Size{5, 5}), {}, {}};
  EXPECT_THAT([&] { fill_mcmd(unknown); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no known cell")));
  const Dem torn{Raster<float>(Size{5, 5}), Mask(Size{5, 4}, 1), {}, {}};
  EXPECT_THAT([&] { fill_mcmd(torn); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("5 x 4; must be 5 x 5")));
  EXPECT_THAT(
      [&] {
        fill_mcmd(dem, {}, {}, Raster<CellKind>(Size{2, 2}));
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("kinds is 2 x 2")));
}

}  // namespace
}  // namespace dem
