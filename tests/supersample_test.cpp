#include "dem/supersample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace dem {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

template <class Surface>
Dem surface_of(int cols, int rows, const Surface& surface) {
  Dem dem{Raster<float>({cols, rows}), Mask({cols, rows}, 1), {}, {1, 1}};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < cols; ++c) dem.z(c, r) = float(surface(c, r));
  return dem;
}

double hills(double c, double r) { return 50 * std::sin(c / 4) * std::cos(r / 5); }
double plane(double c, double r) { return 10 + 3 * c - 2 * r; }

ChosenMethod spline() { return find_method(fill_methods(), "spline"); }

TEST(FinerLattice, CoversTheSameGround) {
  Dem dem = surface_of(30, 20, plane);
  dem.ref.to_world = {1000, 10, 0, 5000, 0, -10};
  dem.spacing = {10, 10};
  const Lattice edges = finer_lattice(dem, {.factor = 2.5});
  EXPECT_EQ(edges.size, (Size{75, 50}));
  EXPECT_DOUBLE_EQ(edges.ref.to_world[0] - edges.ref.to_world[1] / 2, 995);
  EXPECT_DOUBLE_EQ(edges.ref.to_world[1], 4);
  const Lattice nodes = finer_lattice(dem, {.factor = 3, .nodes = true});
  EXPECT_EQ(nodes.size, (Size{88, 58}));
  EXPECT_DOUBLE_EQ(nodes.ref.to_world[0], 1000);
  EXPECT_DOUBLE_EQ(nodes.ref.to_world[0] + 87 * nodes.ref.to_world[1], 1290);
}

TEST(Supersample, KeepsHeightsWhereCentresCoincideBitForBit) {
  const Dem dem = surface_of(21, 17, hills);
  const auto odd = supersample(dem, spline(), {.factor = 3}).filled.z;
  const auto nodes = supersample(dem, spline(), {.factor = 2, .nodes = true}).filled.z;
  for (int r = 0; r < 17; ++r)
    for (int c = 0; c < 21; ++c) {
      ASSERT_EQ(odd(3 * c + 1, 3 * r + 1), dem.z(c, r));
      ASSERT_EQ(nodes(2 * c, 2 * r), dem.z(c, r));
    }
}

TEST(Supersample, FindsTheHillsBetween) {
  const auto fine = supersample(surface_of(40, 36, hills), spline(), {.factor = 2}).filled.z;
  for (int r = 6; r < 66; ++r)
    for (int c = 6; c < 74; ++c) EXPECT_NEAR(fine(c, r), hills(c / 2. - 0.25, r / 2. - 0.25), 1);
}

TEST(Supersample, IsExactOnPlanes) {
  for (const double factor : {1.3, 2., 2.5, 4.}) {
    const Dem dem = surface_of(20, 18, plane);
    const Lattice lattice = finer_lattice(dem, {.factor = factor});
    const auto fine = supersample(dem, spline(), {.factor = factor}).filled.z;
    for (int r = 0; r < fine.rows(); ++r)
      for (int c = 0; c < fine.cols(); ++c)
        ASSERT_NEAR(fine(c, r),
                    plane(lattice.ref.to_world[0] + lattice.ref.to_world[1] * c,
                          -(lattice.ref.to_world[3] + lattice.ref.to_world[5] * r)),
                    0.02)
            << factor;
  }
}

TEST(Supersample, KeepsBlockMeans) {
  const Dem dem = surface_of(24, 20, hills);
  const auto fine = supersample(dem, spline(), {.factor = 4, .preserve = Preserve::means}).filled.z;
  for (int r = 0; r < 20; ++r)
    for (int c = 0; c < 24; ++c) {
      double sum = 0;
      for (int i = 0; i < 16; ++i) sum += fine(4 * c + i % 4, 4 * r + i / 4);
      ASSERT_NEAR(sum / 16, dem.z(c, r), 2e-3);
    }
}

TEST(Supersample, KeepsBlockMeansOfAnyFactor) {
  const auto out = supersample(surface_of(24, 20, hills), spline(),
                               {.factor = 2.4, .preserve = Preserve::means});
  EXPECT_LT(out.miss_max_m, 1.1e-3);
}

TEST(Supersample, RefusesFactorsNotAboveOne) {
  const Dem dem = surface_of(4, 4, plane);
  for (const double factor : {1., 0., -2., std::nan("")})
    EXPECT_THAT(
        [&] { supersample(dem, spline(), {.factor = factor}); },
        ThrowsMessage<std::invalid_argument>(HasSubstr("must be a number in (1, 2147483646]")));
  EXPECT_THAT([&] { supersample(dem, spline(), {.factor = 1e9}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("fewer than 2^31")));
}

}  // namespace
}  // namespace dem
