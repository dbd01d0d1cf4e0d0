#include "dem/breakdown.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Raster<float> line(std::initializer_list<float> values) {
  Raster<float> z({int(values.size()), 1});
  std::ranges::copy(values, z.cells().begin());
  return z;
}

Mask everywhere(const Raster<float>& z) { return Mask(z.size(), 1); }

TEST(Histogram, PutsEachValueInOneBinOrBesideThem) {
  const Raster<float> z = line({-3, -2, -1.5, 0, 1, 1.99f, 2, 2.01f});
  const Histogram h = histogram(z, everywhere(z), -2, 2, 4);
  EXPECT_THAT(h.cells, ElementsAre(2, 0, 1, 3));  // the last bin holds its upper end
  EXPECT_EQ(h.below, 1u);
  EXPECT_EQ(h.above, 1u);
  EXPECT_EQ(h.width(), 1);
}

TEST(Histogram, LooksOnlyWhereItIsTold) {
  const Raster<float> z = line({0, 1, 2});
  Mask where = everywhere(z);
  where(1, 0) = 0;
  EXPECT_THAT(histogram(z, where, 0, 3, 3).cells, ElementsAre(1, 0, 1));
}

TEST(Quantiles, AreOfTheNearestRank) {
  const Raster<float> z = line({50, 10, 40, 20, 30});
  const double parts[] = {1, 0, 0.5, 0.2, 0.21};
  EXPECT_THAT(quantiles(z, everywhere(z), parts), ElementsAre(50, 10, 30, 10, 20));
}

TEST(ErrorsBy, BreaksDownByClass) {
  const Raster<float> error = line({3, -4, 1, 7, 100, 100});
  const Raster<float> by = line({0, 1, 2, 2.5f, 4, -1});  // the last two lie outside
  const double bounds[] = {0, 2, 3, 4};
  const auto classes = errors_by(error, everywhere(error), by, bounds);
  ASSERT_EQ(classes.size(), 3u);
  EXPECT_EQ(classes[0].cells, 2u);
  EXPECT_DOUBLE_EQ(classes[0].rmse_m, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(classes[0].bias_m, -0.5);
  EXPECT_DOUBLE_EQ(classes[0].by_rms, std::sqrt(0.5));
  EXPECT_EQ(classes[1].cells, 2u);
  EXPECT_DOUBLE_EQ(classes[1].rmse_m, 5);
  EXPECT_EQ(classes[2].cells, 0u);
  EXPECT_TRUE(std::isnan(classes[2].rmse_m));
}

TEST(ErrorsBy, SquaresAddUpToThoseOfAllCells) {
  Raster<float> error({40, 30}), by({40, 30});
  double squares = 0;
  for (int row = 0; row < 30; ++row)
    for (int col = 0; col < 40; ++col) {
      error(col, row) = float(signed_uniform(random_bits(1, 0, col, row)));
      by(col, row) = float(signed_uniform(random_bits(2, 0, col, row)));
      squares += double(error(col, row)) * double(error(col, row));
    }
  const double bounds[] = {-1, -0.2, 0.1, 1.01};
  double sum = 0;
  for (const auto& c : errors_by(error, everywhere(error), by, bounds))
    sum += c.rmse_m * c.rmse_m * double(c.cells);
  EXPECT_NEAR(sum, squares, 1e-9);  // sums of 1200 doubles below 1
}

TEST(DistanceToKnown, IsThatOfASearchThroughAllKnownCells) {
  const Spacing cell{20, 30};
  Mask known({37, 23});
  for (int row = 0; row < 23; ++row)
    for (int col = 0; col < 37; ++col)
      known(col, row) = signed_uniform(random_bits(3, 0, col, row)) > 0.96;
  ASSERT_GT(count(known), 3u);
  const Raster<float> distance = distance_to_known(known, cell);
  for (int row = 0; row < 23; ++row)
    for (int col = 0; col < 37; ++col) {
      double nearest = 1e9;
      for (int r = 0; r < 23; ++r)
        for (int c = 0; c < 37; ++c)
          if (known(c, r))
            nearest = std::min(nearest, std::hypot(cell.dx_m * (c - col), cell.dy_m * (r - row)));
      EXPECT_NEAR(double(distance(col, row)), nearest, 1e-4) << col << "," << row;  // float32
    }
}

TEST(Breakdown, MisuseIsNamed) {
  const Raster<float> z = line({1, 2});
  const Mask all = everywhere(z), other({3, 1}, 1), none({2, 1});
  const double half[] = {0.5}, two[] = {2}, falling[] = {1, 0};
  const auto throws = [](auto call, const char* words) {
    EXPECT_THAT(call, ThrowsMessage<std::invalid_argument>(HasSubstr(words)));
  };
  throws([&] { histogram(z, other, 0, 1, 1); }, "where is 3 x 1; must be 2 x 1");
  throws([&] { histogram(z, all, 1, 1, 1); }, "low = 1; must be < 1");
  throws([&] { histogram(z, all, 0, 1, 0); }, "bins = 0");
  throws([&] { quantiles(z, none, half); }, "where has no cell");
  throws([&] { quantiles(z, all, two); }, "part = 2");
  throws([&] { errors_by(z, all, z, falling); }, "bounds = 1, 0; must be two or more, ascending");
  throws([&] { distance_to_known(none, {1, 1}); }, "known has no cell");
  throws([&] { distance_to_known(all, {0, 1}); }, "spacing = 0 x 1 m");
}

}  // namespace
}  // namespace dem
