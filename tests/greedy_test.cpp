#include "dem/greedy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "dem/sample.h"

namespace dem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Dem hills(int cols, int rows) {
  Dem dem{Raster<float>({cols, rows}), Mask({cols, rows}, 1), {}, {1, 1}};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < cols; ++c)
      dem.z(c, r) = float(60 * std::sin(c / 9.) * std::cos(r / 7.) + 0.5 * std::abs(c - r));
  return dem;
}

ChosenMethod method(const char* name) { return find_method(fill_methods(), name); }

double worst_error(const Dem& truth, const Raster<float>& got) {
  double worst = 0;
  for (std::size_t i = 0; i < got.cells().size(); ++i)
    if (truth.known.cells()[i])
      worst = std::max(worst, std::abs(double(got.cells()[i]) - double(truth.z.cells()[i])));
  return worst;
}

TEST(SampleGreedy, KeepsExactlyTheCountAskedFor) {
  const Dem dem = hills(50, 40);
  for (const std::size_t n : {4u, 5u, 100u, 777u, 2000u}) {
    const GreedySample s = sample_greedy(dem, method("mcmd"), {.count = n});
    EXPECT_EQ(count(s.dem.known), n);
    EXPECT_EQ(s.rounds.back().kept, n);
  }
}

TEST(SampleGreedy, GuaranteesTheLargestError) {
  Dem dem = hills(44, 40);
  for (int c = 20; c < 30; ++c) dem.known(c, 33) = 0;
  for (const char* name : {"mcmd", "spline"})
    for (const double most : {8., 1.}) {
      const GreedySample s = sample_greedy(dem, method(name), {.max_error_m = most});
      const auto m = method(name);
      EXPECT_LE(worst_error(dem, m.method->fill(s.dem, m.settings, {}).z), most) << name;
      EXPECT_LT(count(s.dem.known), count(dem.known) * 9 / 10) << name;
      for (std::size_t i = 0; i < dem.z.cells().size(); ++i)
        if (s.dem.known.cells()[i]) {
          ASSERT_TRUE(dem.known.cells()[i]);
          ASSERT_EQ(s.dem.z.cells()[i], dem.z.cells()[i]);
        }
    }
}

TEST(SampleGreedy, BeatsRandomCells) {
  const Dem dem = hills(60, 60);
  const auto m = method("spline");
  const GreedySample s = sample_greedy(dem, m, {.count = 200});
  const Dem random = sample_random(dem, 200);
  const auto rmse = [&](const Dem& sampled) {
    const Raster<float> got = m.method->fill(sampled, m.settings, {}).z;
    double sum = 0;
    for (std::size_t i = 0; i < got.cells().size(); ++i)
      sum += std::pow(got.cells()[i] - dem.z.cells()[i], 2);
    return std::sqrt(sum / 3600);
  };
  EXPECT_LT(rmse(s.dem), 0.7 * rmse(random));
  EXPECT_NEAR(s.rounds.back().rmse_m, rmse(s.dem), 1e-9);
}

TEST(SampleGreedy, RefusesBothOrNeither) {
  const Dem dem = hills(10, 10);
  const auto fails = [&](GreedyOptions o, const char* says) {
    EXPECT_THAT([&] { sample_greedy(dem, method("mcmd"), o); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(says)));
  };
  fails({}, "exactly one");
  fails({.count = 5, .max_error_m = 1}, "exactly one");
  fails({.count = 101}, "must be in [4, 100]");
}

}  // namespace
}  // namespace dem
