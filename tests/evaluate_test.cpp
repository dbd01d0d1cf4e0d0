#include "dem/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

constexpr Spacing kCell{1, 1};
const std::span<const Spacing> kOne(&kCell, 1);

Raster<float> plane(Size size, double east, double south) {
  Raster<float> z(size);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) z(col, row) = float(east * col + south * row);
  return z;
}

/// White noise of variance 1/3 * height^2.
Raster<float> noise(Size size, std::uint64_t seed, double height) {
  Raster<float> z(size);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      z(col, row) = float(height * signed_uniform(random_bits(seed, 0, col, row)));
  return z;
}

TEST(Compare, ErrorsOfAKnownVector) {
  // e = 0 1 2 ... 9 and -100: sorted |e| 0 .. 9, 100; median of e 4.
  Raster<float> truth({11, 1}, 50), got({11, 1}, 50);
  for (int i = 0; i < 10; ++i) got(i, 0) += float(i);
  got(10, 0) -= 100;
  const Errors e = compare(truth, got, Mask({11, 1}, 1), kOne);
  EXPECT_EQ(e.cells, 11u);
  EXPECT_DOUBLE_EQ(e.rmse_m, std::sqrt((285.0 + 10000) / 11));
  EXPECT_DOUBLE_EQ(e.mae_m, 145.0 / 11);
  EXPECT_DOUBLE_EQ(e.bias_m, -55.0 / 11);
  EXPECT_DOUBLE_EQ(e.nmad_m, 1.4826 * 3);  // |e - 4|: 0 1 1 2 2 [3] 3 4 4 5 104
  EXPECT_DOUBLE_EQ(e.le90_m, 9);           // rank ceil(9.9) = 10 of 11
  EXPECT_DOUBLE_EQ(e.max_m, 100);
  EXPECT_TRUE(std::isnan(e.slope_rmse_deg));  // no cell has eight neighbours
}

TEST(Compare, LooksOnlyWhereItIsTold) {
  Raster<float> truth({5, 4}, 0), got({5, 4}, 9);
  Mask where({5, 4});
  got(4, 3) = -2;
  where(4, 3) = 1;
  const Errors e = compare(truth, got, where, kOne);
  EXPECT_EQ(e.cells, 1u);
  for (const double value : {e.rmse_m, e.mae_m, -e.bias_m, e.le90_m, e.max_m}) EXPECT_EQ(value, 2);
  EXPECT_EQ(e.nmad_m, 0);
  EXPECT_TRUE(std::isnan(e.slope_rmse_deg));
}

TEST(Compare, TheMedianOfAnEvenNumberIsTheMiddleOfTwo) {
  Raster<float> truth({4, 1}), got({4, 1});
  const float errors[] = {8, 1, 2, 0};
  std::ranges::copy(errors, got.cells().begin());
  // Median 1.5; |e - 1.5| = 6.5 0.5 0.5 1.5, whose median is 1.
  EXPECT_DOUBLE_EQ(compare(truth, got, Mask({4, 1}, 1), kOne).nmad_m, 1.4826);
}

TEST(Compare, EqualRastersHaveNoError) {
  const auto z = noise({40, 30}, 1, 100);
  const Errors e = compare(z, z, Mask(z.size(), 1), kOne);
  for (const double value :
       {e.rmse_m, e.mae_m, e.bias_m, e.nmad_m, e.le90_m, e.max_m, e.slope_rmse_deg})
    EXPECT_EQ(value, 0);
}

TEST(Compare, SlopeErrorOfTwoPlanes) {
  // 45 degrees against 30: 15 everywhere but on the rim, where nothing is asked.
  const auto truth = plane({9, 9}, 30, 0),
             got = plane({9, 9}, 0, 90 * std::tan(std::numbers::pi / 6));
  const std::vector<Spacing> spacing(9, Spacing{30, 90});
  const Errors e = compare(truth, got, Mask({9, 9}, 1), spacing);
  EXPECT_NEAR(e.slope_rmse_deg, 15, 1e-4);  // heights are rounded to float: 1e-7 of 400 m
}

TEST(Compare, IsTheDenseSum) {
  // Against sums in another order; they differ by rounding only.
  const auto truth = noise({123, 77}, 1, 800), got = noise({123, 77}, 2, 800);
  Mask where(truth.size());
  for (int row = 0; row < 77; ++row)
    for (int col = 0; col < 123; ++col) where(col, row) = (col * 7 + row * 3) % 5 < 2;
  std::vector<double> e;
  const auto slope_truth = slope_deg(truth, kOne), slope_got = slope_deg(got, kOne);
  double slopes = 0, n = 0;
  for (int col = 122; col >= 0; --col)
    for (int row = 76; row >= 0; --row) {
      if (!where(col, row)) continue;
      e.push_back(double(got(col, row)) - double(truth(col, row)));
      if (col == 0 || row == 0 || col == 122 || row == 76) continue;
      slopes += std::pow(double(slope_got(col, row)) - double(slope_truth(col, row)), 2);
      ++n;
    }
  double squares = 0, sum = 0;
  for (const double v : e) squares += v * v, sum += v;
  std::vector<double> absolute;
  for (const double v : e) absolute.push_back(std::abs(v));
  std::ranges::sort(absolute);
  const Errors errors = compare(truth, got, where, kOne);
  EXPECT_EQ(errors.cells, e.size());
  EXPECT_NEAR(errors.rmse_m, std::sqrt(squares / double(e.size())), 1e-9);
  EXPECT_NEAR(errors.bias_m, sum / double(e.size()), 1e-9);
  EXPECT_NEAR(errors.slope_rmse_deg, std::sqrt(slopes / n), 1e-4);  // slope_deg is float
  const auto rank = std::size_t(std::ceil(0.9 * double(e.size())));
  EXPECT_NEAR(errors.le90_m, absolute[rank - 1], 1e-3);  // ranked in float
}

TEST(Compare, ThreadsDoNotChangeIt) {
  const auto truth = noise({300, 2100}, 1, 800), got = noise({300, 2100}, 2, 800);
  const Mask where(truth.size(), 1);
  const Errors one = compare(truth, got, where, kOne, {.threads = 1});
  const Errors two = compare(truth, got, where, kOne, {.threads = 2});
  EXPECT_EQ(one.rmse_m, two.rmse_m);
  EXPECT_EQ(one.bias_m, two.bias_m);
  EXPECT_EQ(one.nmad_m, two.nmad_m);
  EXPECT_EQ(one.slope_rmse_deg, two.slope_rmse_deg);
}

TEST(Compare, RefusesWhatDoesNotFit) {
  const Raster<float> z({4, 3});
  const Mask all({4, 3}, 1);
  EXPECT_THROW(compare(z, Raster<float>({3, 4}), all, kOne), std::invalid_argument);
  EXPECT_THROW(compare(z, z, Mask({4, 4}, 1), kOne), std::invalid_argument);
  EXPECT_THROW(compare(z, z, Mask({4, 3}), kOne), std::invalid_argument);
  EXPECT_THROW(compare(z, z, all, std::vector<Spacing>(2)), std::invalid_argument);
  EXPECT_THROW(compare(z, z, all, std::vector<Spacing>(3, Spacing{0, 1})), std::invalid_argument);
}

TEST(SlopeDeg, OfAPlaneIsExactAndZeroOnTheRim) {
  const auto slope = slope_deg(plane({6, 5}, 60, 120), std::vector<Spacing>{{20, 30}});
  for (int row = 0; row < 5; ++row)
    for (int col = 0; col < 6; ++col) {
      const bool rim = row == 0 || col == 0 || row == 4 || col == 5;
      EXPECT_FLOAT_EQ(slope(col, row), rim ? 0 : float(std::atan(5.0) * 180 / std::numbers::pi));
    }
}

TEST(SlopeDeg, TakesEachRowsSpacing) {
  const std::vector<Spacing> spacing{{1, 1}, {10, 1}, {20, 1}, {1, 1}};
  const auto slope = slope_deg(plane({3, 4}, 10, 0), spacing);
  EXPECT_FLOAT_EQ(slope(1, 1), 45);
  EXPECT_FLOAT_EQ(slope(1, 2), float(std::atan(0.5) * 180 / std::numbers::pi));
}

TEST(SlopeDeg, OfASingleRowOrColumnIsZero) {
  for (const Size size : {Size{1, 1}, {7, 1}, {1, 7}, {2, 2}})
    EXPECT_EQ(slope_deg(plane(size, 3, 3), kOne), Raster<float>(size, 0));
}

TEST(PowerSpectrum, OfWhiteNoiseIsFlatAtItsVariance) {
  const Spacing cell{20, 30};
  const auto z = noise({256, 200}, 3, 10);
  const double expected = 100.0 / 3 * 20 * 30;
  for (const auto& bin : power_spectrum(z, cell)) {
    // A wave's power has a standard deviation of its mean; Hann's window ties about four together.
    const double deviation = expected * std::sqrt(4 / double(bin.waves));
    if (bin.wavelength_m < 2000) {
      EXPECT_NEAR(bin.power_m2, expected, 4 * deviation) << bin.wavelength_m;
    }
  }
}

TEST(PowerSpectrum, OfAWaveIsItsPowerInItsRing) {
  // 8 periods over 320 cells of 25 m: a wavelength of 1000 m, eight times under the side.
  Raster<float> z({320, 320});
  for (int row = 0; row < 320; ++row)
    for (int col = 0; col < 320; ++col)
      z(col, row) = float(100 * std::cos(2 * std::numbers::pi * 8 * col / 320.0));
  double total = 0, peak = 0, at = 0;
  for (const auto& bin : power_spectrum(z, {25, 25}, 1)) {
    const double power = bin.power_m2 * double(bin.waves);
    total += power;
    if (power > peak) peak = power, at = bin.wavelength_m;
  }
  EXPECT_NEAR(at, 1000, 1e-9);
  EXPECT_GT(peak, 0.999 * total);
  // Parseval: twice the power of the half plane, per wave's share of the plane, is the variance.
  EXPECT_NEAR(2 * total / (8000.0 * 8000.0), 5000, 5);
}

TEST(PowerSpectrum, EqualsTheDenseTransform) {
  // 12 x 10 cells by the definition, each wave of the half plane in the ring it belongs to.
  const auto z = noise({12, 10}, 4, 5);
  const auto spectrum = power_spectrum(z, {2, 2}, 1);
  double mean = 0, along_x = 0, along_y = 0;
  for (int r = 0; r < 10; ++r)
    for (int c = 0; c < 12; ++c) {
      mean += z(c, r) / 120.0;
      along_x += z(c, r) * (c - 5.5) / (10 * 143.0);
      along_y += z(c, r) * (r - 4.5) / (12 * 82.5);
    }
  const auto window = [](int i, int n) {
    return (1 - std::cos(2 * std::numbers::pi * (i + 0.5) / n)) / 2;
  };
  std::vector<double> power(8), waves(8);
  for (int v = -4; v <= 5; ++v)
    for (int u = -5; u <= 6; ++u) {
      std::complex<double> f = 0;
      double squares = 0;
      for (int r = 0; r < 10; ++r)
        for (int c = 0; c < 12; ++c) {
          const double w = window(c, 12) * window(r, 10);
          const double rest = z(c, r) - mean - along_x * (c - 5.5) - along_y * (r - 4.5);
          f += rest * w * std::polar(1.0, -2 * std::numbers::pi * (u * c / 12.0 + v * r / 10.0));
          squares += w * w;
        }
      const double k = std::hypot(u / 24.0, v / 20.0);
      if (k == 0 || k > 0.25 + 1e-12) continue;
      // Both halves of the plane: conjugate waves count one half each; those on the line u = 6
      // and v = 5 are met once here and stand for themselves.
      const auto ring = std::size_t(std::lround(std::log2(k * 24)));
      const double share = u == 6 || v == 5 ? 1 : 0.5;
      power[ring] += share * std::norm(f) / squares * 4;
      waves[ring] += share;
    }
  ASSERT_EQ(spectrum.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(spectrum[i].wavelength_m, 24 / std::exp2(double(i)), 1e-12);
    EXPECT_NEAR(double(spectrum[i].waves), waves[i], 1e-12);
    EXPECT_NEAR(spectrum[i].power_m2, power[i] / waves[i], 1e-4 * power[i] / waves[i]);
  }
}

TEST(PowerSpectrum, LeavesAPlaneAtZero) {
  for (const auto& bin : power_spectrum(plane({64, 49}, 3, -2), {10, 10}))
    EXPECT_LT(bin.power_m2, 1e-12);
}

TEST(PowerSpectrum, CropsToSidesThatTransformFast) {
  // 1031 and 97 are prime: 1029 = 3 * 7^3 and 96 columns and rows are used; the rest must not
  // matter.
  auto z = noise({1031, 97}, 5, 10);
  const auto before = power_spectrum(z, {1, 1});
  for (int row = 0; row < 97; ++row) z(1029, row) = z(1030, row) = 1e6f;
  for (int col = 0; col < 1031; ++col) z(col, 96) = -1e6f;
  const auto after = power_spectrum(z, {1, 1});
  ASSERT_EQ(before.size(), after.size());
  EXPECT_EQ(before.front().wavelength_m, 1029);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(before[i].power_m2, after[i].power_m2);
}

TEST(PowerSpectrum, OfASingleRowIsThatOfItsLine) {
  const auto z = noise({4096, 1}, 6, 10);
  const auto spectrum = power_spectrum(z, {5, 5});
  EXPECT_EQ(spectrum.front().wavelength_m, 4096 * 5);
  // The last full ring averages 600 waves: 4 standard deviations of 1 / sqrt(600), times
  // Hann's 1.4.
  EXPECT_NEAR(spectrum[spectrum.size() - 2].power_m2, 100.0 / 3 * 25, 0.25 * 100.0 / 3 * 25);
  EXPECT_TRUE(power_spectrum(Raster<float>({1, 1}), {}).empty());
}

TEST(PowerSpectrum, RefusesNonsense) {
  EXPECT_THROW(power_spectrum({}, {}), std::invalid_argument);
  EXPECT_THROW(power_spectrum(Raster<float>({4, 4}), {0, 1}), std::invalid_argument);
  EXPECT_THROW(power_spectrum(Raster<float>({4, 4}), {}, 0), std::invalid_argument);
}

/// 128 x 128 cells: cosines of every wave up to 40 a side, random phases, amplitude k^(-beta / 2).
Raster<float> fractal(double beta, std::uint64_t seed) {
  constexpr int kSide = 128, kMost = 40;
  std::vector<std::complex<double>> turn(kSide);
  for (int i = 0; i < kSide; ++i)
    turn[std::size_t(i)] = std::polar(1.0, 2 * std::numbers::pi * i / kSide);
  Raster<double> sum({kSide, kSide});
  for (int u = 0; u <= kMost; ++u) {
    std::vector<std::complex<double>> rows(kSide);
    for (int v = u == 0 ? 1 : -kMost; v <= kMost; ++v) {
      const double phase = std::numbers::pi * signed_uniform(random_bits(seed, 0, u, v));
      const auto wave = std::polar(std::pow(std::hypot(u, v), -beta / 2), phase);
      for (int row = 0; row < kSide; ++row)
        rows[std::size_t(row)] += wave * turn[std::size_t((v + kSide) * row % kSide)];
    }
    for (int row = 0; row < kSide; ++row)
      for (int col = 0; col < kSide; ++col)
        sum(col, row) += (rows[std::size_t(row)] * turn[std::size_t(u * col % kSide)]).real();
  }
  Raster<float> z(sum.size());
  std::ranges::transform(sum.cells(), z.cells().begin(), [](double h) { return float(h); });
  return z;
}

TEST(SpectralSlope, FindsTheExponentOfASum) {
  // Between 4 and 32 waves a side. The ring of 4 waves has few of them, tied by Hann's window: one
  // surface leaves about 0.17, the mean of 16 about 0.04; four of these are allowed.
  for (const double beta : {2.0, 3.0}) {
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 16; ++seed)
      sum += spectral_slope(power_spectrum(fractal(beta, seed), {30, 30}), 115, 985);
    EXPECT_NEAR(sum / 16, beta, 0.16);
  }
}

TEST(SpectralSlope, IsExactOnAPowerLaw) {
  std::vector<SpectrumBin> spectrum;
  for (const double length : {100.0, 200.0, 500.0, 1000.0})
    spectrum.push_back({length, 3 * std::pow(length, 2.5), 1});
  spectrum.push_back({5000, 1, 1});  // outside of the range
  EXPECT_NEAR(spectral_slope(spectrum, 100, 1000), 2.5, 1e-12);
  EXPECT_TRUE(std::isnan(spectral_slope(spectrum, 150, 300)));
  EXPECT_TRUE(std::isnan(spectral_slope({}, 1, 300)));
}

}  // namespace
}  // namespace dem
