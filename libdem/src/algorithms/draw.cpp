#include "dem/draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "gradient.h"
#include "parallel.h"

namespace dem {
namespace {

constexpr Rgb kWhite{255, 255, 255};

void check_drawable(const Raster<float>& z, Spacing cell, const HillshadeOptions& options,
                    const Mask& known) {
  if (z.empty()) throw std::invalid_argument("z has no cells; at least one is needed");
  if (!known.empty() && known.size() != z.size())
    throw std::invalid_argument(fmt::format("known is {} x {}; must be {} x {} as z", known.cols(),
                                            known.rows(), z.cols(), z.rows()));
  if (!(cell.dx_m > 0 && cell.dy_m > 0 && std::isfinite(cell.dx_m) && std::isfinite(cell.dy_m)))
    throw std::invalid_argument(
        fmt::format("spacing = {} x {} m; must be > 0", cell.dx_m, cell.dy_m));
  if (!std::isfinite(options.azimuth_deg))
    throw std::invalid_argument(
        fmt::format("azimuth_deg = {}; must be a finite number", options.azimuth_deg));
  if (!(options.altitude_deg >= 0 && options.altitude_deg <= 90))
    throw std::invalid_argument(
        fmt::format("altitude_deg = {}; must be in [0, 90]", options.altitude_deg));
  if (!std::isfinite(options.exaggeration))
    throw std::invalid_argument(
        fmt::format("exaggeration = {}; must be a finite number", options.exaggeration));
}

/// How bright ground of a given gradient is under one light: the cosine between its normal and the
/// way to the light, 0 in the shade.
class Light {
 public:
  explicit Light(const HillshadeOptions& options) : exaggeration_(options.exaggeration) {
    const double azimuth = options.azimuth_deg * std::numbers::pi / 180;
    const double altitude = options.altitude_deg * std::numbers::pi / 180;
    east_ = std::sin(azimuth) * std::cos(altitude);
    south_ = -std::cos(azimuth) * std::cos(altitude);
    up_ = std::sin(altitude);
  }

  double on(Gradient g) const {
    const double east = g.east * exaggeration_, south = g.south * exaggeration_;
    const double cosine =
        (up_ - east * east_ - south * south_) / std::sqrt(1 + east * east + south * south);
    return std::clamp(cosine, 0.0, 1.0);
  }

 private:
  double east_, south_, up_, exaggeration_;
};

std::uint8_t byte(double value) {
  return std::uint8_t(std::floor(std::clamp(value, 0.0, 255.0) + 0.5));
}

/// Terrain colours from the lowest (0) to the highest (1) ground.
std::array<double, 3> terrain_colour(double height) {
  struct Stop {
    double height;
    std::array<double, 3> rgb;
  };
  static constexpr std::array<Stop, 7> kStops{{{0.00, {84, 132, 108}},
                                               {0.15, {126, 167, 118}},
                                               {0.32, {186, 197, 138}},
                                               {0.50, {222, 207, 156}},
                                               {0.68, {198, 165, 124}},
                                               {0.85, {176, 150, 136}},
                                               {1.00, {245, 243, 240}}}};
  std::size_t i = 1;
  while (i + 1 < kStops.size() && height > kStops[i].height) ++i;
  const Stop &low = kStops[i - 1], &high = kStops[i];
  const double t = (height - low.height) / (high.height - low.height);
  std::array<double, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c) rgb[c] = low.rgb[c] + t * (high.rgb[c] - low.rgb[c]);
  return rgb;
}

}  // namespace

Raster<std::uint8_t> hillshade(const Raster<float>& z, Spacing spacing,
                               const HillshadeOptions& options) {
  check_drawable(z, spacing, options, {});
  const Light light(options);
  const Mask all;
  const GradientOf gradient(z, all, spacing);
  Raster<std::uint8_t> grey(z.size());
  parallel_for(0, z.rows(), 16, [&](int row) {
    for (int col = 0; col < z.cols(); ++col)
      grey(col, row) = byte(255 * light.on(gradient(col, row)));
  });
  return grey;
}

Raster<Rgb> shaded_relief(const Raster<float>& z, Spacing spacing, const HillshadeOptions& options,
                          const Mask& known) {
  check_drawable(z, spacing, options, known);
  const auto drawn = [&](int col, int row) { return known.empty() || known(col, row) != 0; };
  float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
  for (int row = 0; row < z.rows(); ++row)
    for (int col = 0; col < z.cols(); ++col)
      if (drawn(col, row)) {
        lowest = std::min(lowest, z(col, row));
        highest = std::max(highest, z(col, row));
      }

  // Colour by height times the light; flat ground keeps nine tenths of its colour.
  const Light light(options);
  const double flat = light.on({});
  const double gain = flat > 0 ? 0.9 / flat : 1;
  const double relief = double(highest) - double(lowest);
  const GradientOf gradient(z, known, spacing);
  Raster<Rgb> picture(z.size(), kWhite);
  parallel_for(0, z.rows(), 16, [&](int row) {
    for (int col = 0; col < z.cols(); ++col) {
      if (!drawn(col, row)) continue;
      const double height = relief > 0 ? (double(z(col, row)) - double(lowest)) / relief : 0;
      const auto colour = terrain_colour(height);
      const double shade = std::min(1.0, gain * light.on(gradient(col, row)));
      for (std::size_t c = 0; c < 3; ++c) picture(col, row)[c] = byte(colour[c] * shade);
    }
  });
  return picture;
}

}  // namespace dem
