#include "dem/draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "numeric/gradient.h"
#include "numeric/parallel.h"

namespace dem {
using namespace numeric;
namespace {

constexpr Rgb kWhite{255, 255, 255};
constexpr int kRowsAtOnce = 256;  // between two reports

void check_drawable(const Raster<float>& z, Spacing cell, const Mask& known) {
  if (z.empty()) throw std::invalid_argument("z has no cells; at least one is needed");
  if (!known.empty() && known.size() != z.size())
    throw std::invalid_argument(fmt::format("known is {} x {}; must be {} x {} as z", known.cols(),
                                            known.rows(), z.cols(), z.rows()));
  if (!(cell.dx_m > 0 && cell.dy_m > 0 && std::isfinite(cell.dx_m) && std::isfinite(cell.dy_m)))
    throw std::invalid_argument(
        fmt::format("spacing = {} x {} m; must be > 0", cell.dx_m, cell.dy_m));
}

/// How bright ground of a given gradient is under one light: the cosine between its normal and the
/// way to the light, 0 in the shade.
class Light {
 public:
  Light(double azimuth_deg, double altitude_deg) {
    const double azimuth = azimuth_deg * std::numbers::pi / 180;
    const double altitude = altitude_deg * std::numbers::pi / 180;
    east_ = std::sin(azimuth), south_ = -std::cos(azimuth);
    level_ = std::cos(altitude), up_ = std::sin(altitude);
  }

  double on(Gradient g) const {
    const double cosine =
        (up_ - level_ * (g.east * east_ + g.south * south_)) / std::sqrt(1 + g.squared());
    return std::clamp(cosine, 0.0, 1.0);
  }

  /// Squared sine of the angle between the light and the way the ground falls; level ground: 1/2.
  double across(Gradient g) const {
    const double sine = g.east * south_ - g.south * east_, squared = g.squared();
    return squared > 0 ? sine * sine / squared : 0.5;
  }

 private:
  double east_, south_, level_, up_;
};

/// One light, or the four of a multidirectional hillshade.
class Lights {
 public:
  explicit Lights(const HillshadeOptions& o) : exaggeration_(o.exaggeration) {
    if (!o.multidirectional)
      lights_.emplace_back(o.azimuth_deg, o.altitude_deg);
    else
      for (const double turn : {-90, -45, 0, 45})
        lights_.emplace_back(o.azimuth_deg + turn, o.altitude_deg);
  }

  double on(Gradient g) const {
    g = {g.east * exaggeration_, g.south * exaggeration_};
    if (lights_.size() == 1) return lights_[0].on(g);
    double sum = 0;
    for (const auto& light : lights_) sum += light.across(g) * light.on(g);
    return sum / 2;  // four lights 45 degrees apart: the weights' sum
  }

 private:
  std::vector<Light> lights_;
  double exaggeration_;
};

std::uint8_t byte(double value) {
  return std::uint8_t(std::floor(std::clamp(value, 0.0, 255.0) + 0.5));
}

/// Calls draw(col, row) for every known cell.
template <class Draw>
void for_each_known(Size size, const Mask& known, const Run& run, Draw draw) {
  with_threads(run.threads, [&] {
    for (int first = 0; first < size.rows; first += kRowsAtOnce) {
      run.report(double(first) / size.rows, "draw");
      parallel_for(first, std::min(first + kRowsAtOnce, size.rows), 8, [&](int row) {
        for (int col = 0; col < size.cols; ++col)
          if (known.empty() || known(col, row) != 0) draw(col, row);
      });
    }
  });
}

/// The palette over the known heights.
ColourScale scale(const Raster<float>& z, const Mask& known, const ReliefOptions& options) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (std::size_t i = 0; i < z.cells().size(); ++i)
    if (known.empty() || known.cells()[i] != 0) {
      low = std::min(low, z.cells()[i]);
      high = std::max(high, z.cells()[i]);
    }
  return {options.palette, double(low), double(high), options.sea};
}

/// A colour in a light, where 1 is the light on level ground.
Rgb lit(const Colour& colour, double light) {
  constexpr Colour kSky{0.30, 0.34, 0.42};  // what is left in the shade
  constexpr double kPaler = 0.5;            // how far white is from twice the light on level ground
  Rgb rgb{};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = byte(light < 1 ? colour[c] * (kSky[c] + (1 - kSky[c]) * light)
                            : colour[c] + (255 - colour[c]) * std::min(1.0, kPaler * (light - 1)));
  return rgb;
}

}  // namespace

std::vector<Field> fields(HillshadeOptions& o) {
  return {{"azimuth",
           o.azimuth_deg,
           {-360, 360},
           "degrees",
           "where the light comes from, clockwise from north"},
          {"altitude", o.altitude_deg, {0, 90}, "degrees", "height of the light over the horizon"},
          {"exaggeration", o.exaggeration, {0, 1000}, "", "heights are multiplied by it"},
          {"multidirectional", o.multidirectional, "light from four sides"}};
}

std::vector<Field> fields(ReliefOptions& o) {
  auto all = fields(o.light);
  all.push_back({"palette", o.palette, palette_names(), "colours by height"});
  all.push_back({"sea", o.sea, "heights at or below 0 m are water"});
  return all;
}

Raster<std::uint8_t> hillshade(const Raster<float>& z, Spacing spacing,
                               const HillshadeOptions& options, const Mask& known, const Run& run) {
  check_options(options);
  check_drawable(z, spacing, known);
  const Lights lights(options);
  const GradientOf gradient(z, known, spacing);
  Raster<std::uint8_t> grey(z.size(), 255);
  for_each_known(z.size(), known, run, [&](int col, int row) {
    grey(col, row) = byte(255 * lights.on(gradient(col, row)));
  });
  return grey;
}

Raster<Rgb> shaded_relief(const Raster<float>& z, Spacing spacing, const ReliefOptions& options,
                          const Mask& known, const Run& run) {
  check_options(options);
  check_drawable(z, spacing, known);
  const Lights lights(options.light);
  const double level = std::max(lights.on({}), 1e-3);
  const ColourScale colour = scale(z, known, options);
  const GradientOf gradient(z, known, spacing);
  Raster<Rgb> picture(z.size(), kWhite);
  for_each_known(z.size(), known, run, [&](int col, int row) {
    picture(col, row) = lit(colour(double(z(col, row))), lights.on(gradient(col, row)) / level);
  });
  return picture;
}

}  // namespace dem
