#include "dem/noise.h"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <vector>

#include "dem/evaluate.h"

namespace dem {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Canvas canvas(int cols, int rows, double cell_m, double x = 0, double y = 0) {
  return {{cols, rows}, {cell_m, cell_m}, {{x, cell_m, 0, y, 0, -cell_m}, ""}};
}

/// The laws by position need a patch of their own to be functions of place alone.
std::vector<NoiseOptions> every_law() {
  NoiseOptions base;
  base.wavelength_m = 2000;
  base.c_t = 0.6;
  base.patch_m = 5000;
  std::vector<NoiseOptions> all;
  for (auto law : {NoiseLaw::fbm, NoiseLaw::heterogeneous, NoiseLaw::hybrid, NoiseLaw::ridged})
    for (auto shape : {NoiseShape::plain, NoiseShape::ridge, NoiseShape::valley}) {
      NoiseOptions o = base;
      o.law = law, o.shape = shape, o.bend = 0.1;
      all.push_back(o);
    }
  for (auto law : {HLaw::linear, HLaw::filling}) {
    NoiseOptions o = base;
    o.H_law = law;
    all.push_back(o);
  }
  base.warp = 0.4;
  all.push_back(base);
  return all;
}

// ---- One noise

TEST(GradientNoise, IsExactlyZeroAtLatticePoints) {
  for (int y = -20; y <= 20; ++y)
    for (int x = -20; x <= 20; ++x) EXPECT_EQ(gradient_noise(x, y, 3), 0.0f) << x << ", " << y;
}

TEST(GradientNoise, HasMeanZeroAndStandardDeviationOneThird) {
  double sum = 0, squares = 0, largest = 0;
  const int n = 600;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double v = double(gradient_noise(i * 1.37, j * 1.41, 5));
      sum += v, squares += v * v, largest = std::max(largest, std::abs(v));
    }
  // 360 000 samples of about as many cells: the error of either is some 0.001.
  EXPECT_NEAR(sum / n / n, 0, 0.005);
  EXPECT_NEAR(std::sqrt(squares / n / n), 1.0 / 3, 0.005);
  EXPECT_LT(largest, 1.6);
}

TEST(GradientNoise, IsSmoothAcrossLatticeLines) {
  // Value, first and second difference on both sides of x = 4.
  const double h = 1e-2, y = 2.3;
  const auto at = [&](double x) { return double(gradient_noise(x, y, 9)); };
  EXPECT_NEAR(at(4 - 1e-6), at(4 + 1e-6), 1e-5);
  EXPECT_NEAR((at(4) - at(4 - h)) / h, (at(4 + h) - at(4)) / h, 0.05);
  const double west = (at(4 - 2 * h) - 2 * at(4 - h) + at(4)) / (h * h);
  const double east = (at(4) - 2 * at(4 + h) + at(4 + 2 * h)) / (h * h);
  // The cubic's second derivative jumps by up to 12 times the difference of two planes.
  EXPECT_NEAR(west, east, 0.8);
}

TEST(GradientNoise, AnotherSeedIsAnotherNoise) {
  EXPECT_NE(gradient_noise(0.5, 0.5, 1), gradient_noise(0.5, 0.5, 2));
}

// ---- Terrain

TEST(GenerateNoise, IsAFunctionOfThePlaceAlone) {
  for (const NoiseOptions& o : every_law()) {
    const Canvas whole = canvas(40, 30, 50, 1000, 7000);
    const Raster<float> z = generate_noise(whole, o);
    // A part of it, cell for cell the same places: the same bits.
    const Raster<float> part = generate_noise(canvas(10, 8, 50, 1000 + 7 * 50, 7000 - 5 * 50), o);
    // Cells five times as fine: every fifth is one of the coarse.
    const Raster<float> fine = generate_noise(canvas(196, 146, 10, 1000, 7000), o);
    for (int r = 0; r < 8; ++r)
      for (int c = 0; c < 10; ++c) {
        EXPECT_EQ(part(c, r), z(c + 7, r + 5));
        EXPECT_NEAR(double(fine(5 * c, 5 * r)), double(z(c, r)), 2e-3);
        EXPECT_EQ(noise_height_m(whole.east_m(c), whole.north_m(r), o), z(c, r));
      }
  }
}

TEST(GenerateNoise, ThreadsDoNotChangeABit) {
  for (const NoiseOptions& o : every_law()) {
    const Canvas c = canvas(70, 150, 30);
    EXPECT_EQ(generate_noise(c, o, {.threads = 1, .progress = {}}),
              generate_noise(c, o, {.threads = 7, .progress = {}}));
  }
}

TEST(GenerateNoise, LawsOfPositionRunOverTheCanvasWhenThereIsNoPatch) {
  NoiseOptions o;
  o.shape = NoiseShape::ridge, o.c_t = 2, o.octaves = 1;
  const Raster<float> z = generate_noise(canvas(101, 101, 100), o);
  for (int r = 0; r < 101; ++r) {
    EXPECT_EQ(z(0, r), 0.0f);
    EXPECT_EQ(z(100, r), 0.0f);
    EXPECT_GT(z(50, r), 0.0f);
  }
}

/// Powers of a row's waves that pass 0, 1, ... to - 1 times, with a Hann window, added to `power`.
void add_powers(std::span<const float> row, std::vector<double>& power) {
  const std::size_t n = row.size();
  std::vector<std::complex<double>> turn(n);
  for (std::size_t i = 0; i < n; ++i)
    turn[i] = std::polar(1.0, 2 * std::numbers::pi * double(i) / double(n));
  for (std::size_t k = 0; k < power.size(); ++k) {
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < n; ++i)
      sum += double(row[i]) * (1 - turn[i].real()) * turn[i * k % n];
    power[k] += std::norm(sum);
  }
}

/// The exponent beta of a profile's spectrum 1/f^beta, from the waves that pass `from` to `to` - 1
/// times along a row: least squares of the logarithms over bands of a third of an octave.
double profile_slope(const Raster<float>& z, int from, int to) {
  std::vector<double> power(static_cast<std::size_t>(to));
  for (int r = 0; r < z.rows(); ++r) add_powers(z.row(r), power);
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (double edge = from; edge < to - 1; edge *= std::cbrt(2.0)) {
    double sum = 0, logs = 0, waves = 0;
    for (int k = int(std::ceil(edge)); k < std::min(double(to), edge * std::cbrt(2.0)); ++k)
      sum += power[std::size_t(k)], logs += std::log(k), waves += 1;
    const double x = logs / waves, y = std::log(sum / waves);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return -(n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(GenerateNoise, ProfilesHaveTheSpectrumOneOverFToTheOnePlusTwoH) {
  // Waves from 8192 cells to 1 cell; the slope is taken from 256 to 16 cells, octaves away from
  // both ends. Rows lie so far apart that they are nearly independent, and at no whole number of
  // lattice cells, or all would cut them at the same height.
  for (double lacunarity : {2.0, 1.7})
    for (double H : {0.2, 0.5, 0.8}) {
      NoiseOptions o;
      o.H = H, o.lacunarity = lacunarity, o.wavelength_m = 8192, o.seed = 11;
      o.octaves = int(std::lround(std::log(8192.0) / std::log(lacunarity)));
      Canvas rows = canvas(2048, 64, 1);
      rows.spacing.dy_m = 517.7, rows.ref.to_world[5] = -517.7;
      const double beta = profile_slope(generate_noise(rows, o), 8, 128);
      EXPECT_NEAR(beta, 1 + 2 * H, 0.05 * (1 + 2 * H)) << "H " << H << " lacunarity " << lacunarity;
    }
}

TEST(GenerateNoise, TheSurfaceIsSteeperByOneThanItsProfiles) {
  NoiseOptions o;
  o.H = 0.7, o.wavelength_m = 4096, o.octaves = 12;
  const auto spectrum = power_spectrum(generate_noise(canvas(512, 512, 1), o), {1, 1}, 3);
  EXPECT_NEAR(spectral_slope(spectrum, 8, 64), 2 + 2 * 0.7, 0.05 * 3.4);
}

TEST(GenerateNoise, HeterogeneousTerrainIsRoughWhereHigh) {
  NoiseOptions o;
  o.law = NoiseLaw::heterogeneous, o.c_t = 0.8, o.wavelength_m = 4000;
  const Raster<float> z = generate_noise(canvas(400, 400, 20), o);
  double high = 0, low = 0, n_high = 0, n_low = 0;
  for (int r = 0; r < 400; ++r)
    for (int c = 1; c < 399; ++c) {
      const double bend = std::abs(double(z(c - 1, r) - 2 * z(c, r) + z(c + 1, r)));
      if (z(c, r) > 900) high += bend, ++n_high;
      if (z(c, r) < 300) low += bend, ++n_low;
    }
  ASSERT_GT(std::min(n_high, n_low), 1000);
  EXPECT_GT(high / n_high, 3 * low / n_low);
}

TEST(GenerateNoise, RoughnessGrowsEastward) {
  NoiseOptions o;
  o.H = 1, o.H_law = HLaw::linear, o.H_east = 0;
  const Raster<float> z = generate_noise(canvas(300, 300, 30), o);
  const auto bend = [&](int from) {
    double sum = 0;
    for (int r = 0; r < 300; ++r)
      for (int c = from; c < from + 60; ++c)
        sum += std::abs(double(z(c - 1, r) - 2 * z(c, r) + z(c + 1, r)));
    return sum;
  };
  EXPECT_GT(bend(230), 10 * bend(10));
}

// ---- Misuse

TEST(GenerateNoise, RefusesBadInputWithItsNameAndValue) {
  const auto message = [](const Canvas& c, const NoiseOptions& o, const char* says) {
    EXPECT_THAT([&] { generate_noise(c, o); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(says)));
  };
  const Canvas good = canvas(3, 3, 30);
  NoiseOptions o;
  message(canvas(0, 3, 30), o, "size = 0 x 3");
  message(canvas(3, 3, -1), o, "spacing = -1");
  message(canvas(100000, 100000, 30), o, "size = 100000 x 100000");
  message(canvas(3, 3, 30, NAN), o, "to_world");
  o.octaves = 0;
  message(good, o, "octaves = 0");
  o = {};
  o.lacunarity = 1;
  message(good, o, "lacunarity = 1");
  o = {};
  o.octaves = 48;
  message(canvas(3, 3, 30, 5e6), o, "too fine");
  o = {};
  o.tilt = 1;
  message(good, o, "tilt = 1");
  o = {};
  o.shape = NoiseShape::ridge;
  EXPECT_THAT([&] { noise_height_m(0, 0, o); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("patch_m = 0")));
  EXPECT_THAT([&] { noise_height_m(NAN, 0); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("must be finite")));
}

TEST(GenerateNoise, OneCellAndOneRowWork) {
  for (const NoiseOptions& law : every_law()) {
    NoiseOptions o = law;
    o.patch_m = 0;
    for (const Size size : {Size{1, 1}, Size{2, 1}, Size{1, 9}, Size{2, 2}}) {
      const Raster<float> z = generate_noise(canvas(size.cols, size.rows, 30), o);
      for (float height : z.cells()) EXPECT_TRUE(std::isfinite(height));
    }
  }
}

TEST(GenerateNoise, StopsWhenAskedTo) {
  const dem::Run stop{1, [](double, std::string_view) { return false; }};
  EXPECT_THROW(generate_noise(canvas(9, 9, 30), {}, stop), Cancelled);
}

}  // namespace
}  // namespace dem
