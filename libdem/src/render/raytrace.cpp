// Perspective views: where the camera stands, what each ray meets, and how that looks.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "dem/raytrace.h"
#include "numeric/gradient.h"
#include "numeric/parallel.h"
#include "numeric/random.h"
#include "render/sky.h"

namespace dem {
using namespace numeric;
using namespace render;
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadian = std::numbers::pi / 180;

double length(Vec3 v) { return std::sqrt(dot(v, v)); }
Vec3 unit(Vec3 v) { return (1 / length(v)) * v; }
Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// A direction on the compass, `up_deg` over the horizon.
Vec3 towards(double azimuth_deg, double up_deg) {
  const double level = std::cos(up_deg * kRadian);
  return {level * std::sin(azimuth_deg * kRadian), level * std::cos(azimuth_deg * kRadian),
          std::sin(up_deg * kRadian)};
}

/// The terrain as a block: its extent, and the plain it stands on. Metres, exaggerated.
struct Block {
  double east, south;  // x runs from 0 to east, y from -south to 0
  double base, top;
};

Block block_of(const Heightfield& ground) {
  const auto [dx, dy] = ground.spacing();
  const double east = (ground.size().cols - 1) * dx, south = (ground.size().rows - 1) * dy;
  if (ground.low() > ground.high()) return {east, south, 0, 0};
  const double relief = ground.high() - ground.low();
  return {east, south, ground.low() - 0.25 * relief - 0.02 * std::max(east, south), ground.high()};
}

/// Exaggeration that makes the relief a twelfth of the terrain's longer side, as a round number of
/// at least 1.
double chosen_exaggeration(const Dem& dem) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i)
    if (dem.known.cells()[i]) {
      low = std::min(low, dem.z.cells()[i]);
      high = std::max(high, dem.z.cells()[i]);
    }
  if (!(high > low)) return 1;
  const double side = std::max(dem.z.cols() * dem.spacing.dx_m, dem.z.rows() * dem.spacing.dy_m);
  const double wished = side / 12 / (double(high) - double(low));
  double round = 1;
  for (const double step : {1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 50.0})
    if (step <= wished) round = step;
  return round;
}

/// A camera that looks along `forward`; a picture as wide as the field of view.
Camera camera_along(Vec3 position, Vec3 forward, const ViewOptions& o) {
  const Vec3 level = cross(forward, {0, 0, 1});
  // Straight down or up, north is up in the picture.
  const Vec3 right = length(level) > 1e-9 ? unit(level) : Vec3{1, 0, 0};
  const double half = std::tan(o.fov_deg * kRadian / 2);
  return {position, forward, half * right, (half * o.height / o.width) * cross(right, forward)};
}

/// The camera that has the block as large as it goes in the middle of the picture.
Camera three_quarter_camera(const Block& block, const ViewOptions& o) {
  constexpr double margin = 1.04;
  const Camera at_origin = camera_along({}, towards(o.heading_deg, -o.tilt_deg), o);
  const auto [position, forward, right, up] = at_origin;
  const double across = dot(right, right), upright = dot(up, up);
  Vec3 middle{block.east / 2, -block.south / 2, (block.base + block.top) / 2};
  double away = 0;
  for (int round = 0; round < 20; ++round) {
    // Back until every corner is in the picture; then the middle to the middle of the corners.
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k)
      corners[k] =
          Vec3{k & 1 ? block.east : 0, k & 2 ? -block.south : 0, k & 4 ? block.top : block.base} -
          middle;
    away = 0;
    for (const Vec3& p : corners)
      away = std::max(away, margin * std::max(std::abs(dot(p, right)) / across,
                                              std::abs(dot(p, up)) / upright) -
                                dot(p, forward));
    double left = 1, to_right = -1, low = 1, high = -1;
    for (const Vec3& p : corners) {
      const double depth = away + dot(p, forward);
      const double x = dot(p, right) / across / depth, y = dot(p, up) / upright / depth;
      left = std::min(left, x), to_right = std::max(to_right, x);
      low = std::min(low, y), high = std::max(high, y);
    }
    middle = middle + (away * (left + to_right) / 2) * right + (away * (low + high) / 2) * up;
  }
  return camera_along(middle - away * forward, forward, o);
}

/// The camera where the options put it.
Camera own_camera(const Heightfield& ground, const Block& block, double exaggeration,
                  const ViewOptions& o) {
  const auto exaggerated = [&](Vec3 v) { return Vec3{v.x, v.y, v.z * exaggeration}; };
  const Vec3 position = exaggerated(*o.camera);
  const Vec3 middle{block.east / 2, -block.south / 2, (ground.low() + ground.high()) / 2};
  const Vec3 target = o.target ? exaggerated(*o.target) : middle;
  if (!std::isfinite(length(position)) || !std::isfinite(length(target)))
    throw std::invalid_argument("camera and target must be finite numbers");
  if (length(target - position) == 0)
    throw std::invalid_argument("camera stands on its target; must be somewhere else");
  if (const auto z = ground.height(position.x, position.y); z && position.z <= *z)
    throw std::invalid_argument(
        fmt::format("camera is {:.1f} m under the ground; must be higher than {:.1f} m here",
                    (*z - position.z) / exaggeration, *z / exaggeration));
  if (position.z <= block.base)
    throw std::invalid_argument(
        fmt::format("camera is at {:.1f} m, under all ground; must be "
                    "higher than {:.1f} m",
                    o.camera->z, block.base / exaggeration));
  return camera_along(position, unit(target - position), o);
}

// Light is linear red, green and blue; 1 is as bright as a picture gets.
using Light = Vec3;
constexpr Light operator*(Light a, Light b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
constexpr Light mixed(Light a, Light b, double share_of_b) {
  return (1 - share_of_b) * a + share_of_b * b;
}

constexpr Light kSunlight{1.38, 1.26, 1.06};
constexpr Light kSkylight{0.33, 0.39, 0.50};
constexpr Light kHorizon{0.72, 0.80, 0.88};
constexpr Light kZenith{0.16, 0.32, 0.62};
constexpr Light kPlain{0.60, 0.61, 0.62};
constexpr Light kEarth{0.30, 0.25, 0.21};

double linear(double srgb) {
  const double s = srgb / 255;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

/// `threshold`, in [0, 1), decides between the two nearest bytes: with one that changes from pixel
/// to pixel an even sky has no bands.
std::uint8_t srgb(double light, double threshold) {
  const double l = std::clamp(light, 0.0, 1.0);
  const double s = l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
  return std::uint8_t(std::min(255.0, std::floor(255 * s + threshold)));
}

/// Linear light for every height, looked up: pow() is too slow for each ray.
class Albedo {
 public:
  explicit Albedo(const ColourScale& scale) : scale_(scale) {
    if (scale.sea) water_ = table(scale.low_m, 0);
    land_ = table(scale.sea ? kShore : scale.low_m, scale.high_m);
  }
  Light at(double height_m) const {
    return scale_.sea && height_m <= kShore ? water_.at(height_m) : land_.at(height_m);
  }

 private:
  static constexpr double kShore = 1e-3;  // rounding along a ray must not make land of the sea

  struct Table {
    double low = 0, per_metre = 0;
    std::array<Light, 1024> lights{};

    Light at(double height_m) const {
      const double i = (height_m - low) * per_metre;
      return lights[std::size_t(std::clamp(i, 0.0, double(lights.size() - 1)) + 0.5)];
    }
  };

  Table table(double low, double high) const {
    Table t{low, 0, {}};
    const double step = (high - low) / double(t.lights.size() - 1);
    if (step > 0) t.per_metre = 1 / step;
    for (std::size_t i = 0; i < t.lights.size(); ++i) {
      const Colour c = scale_(low + std::max(0.0, step) * double(i));
      t.lights[i] = {linear(c[0]), linear(c[1]), linear(c[2])};
    }
    return t;
  }

  ColourScale scale_;
  Table water_, land_;
};

/// What a ray meets first.
struct Sight {
  enum What { sky, ground, side, plain } what = sky;
  double t = kInfinity;
  Vec3 normal{};
};

class Scene {
 public:
  Scene(const Dem& dem, const View& view, const ViewOptions& o, const Run& run)
      : dem_(dem),
        view_(view),
        block_(block_of(view.ground)),
        shadows_(o.shadows),
        sun_(towards(o.azimuth_deg, o.altitude_deg)),
        gradient_(dem.z, dem.known, dem.spacing),
        albedo_({o.palette, view.ground.low() / view.exaggeration,
                 view.ground.high() / view.exaggeration, o.sea}),
        sky_view_(dem, view.exaggeration, run) {
    // Air counts from where the terrain may begin.
    const Vec3 eye = view.camera.position;
    const auto beyond = [](double x, double lo, double hi) {
      return std::max({lo - x, x - hi, 0.0});
    };
    clear_ = length({beyond(eye.x, 0, block_.east), beyond(eye.y, -block_.south, 0),
                     beyond(eye.z, block_.base, block_.top)});
    haze_ = (o.camera ? 0.9 : 0.3) * o.haze / std::hypot(block_.east, block_.south);
    lift_ = 0.02 * std::min(dem.spacing.dx_m, dem.spacing.dy_m);
  }

  Light seen(const Ray& ray) const {
    const double metres = length(ray.direction);
    const Sight sight = first(ray);
    if (sight.what == Sight::sky) return sky(1 / metres * ray.direction);
    const Vec3 p = ray.origin + sight.t * ray.direction;
    Light light{};
    if (sight.what == Sight::ground) light = ground(p, sight.normal);
    if (sight.what == Sight::side) light = side(p, sight.normal);
    if (sight.what == Sight::plain) light = plain(p);
    const double air = std::max(0.0, sight.t * metres - clear_);
    return mixed(light, kHorizon, 1 - std::exp(-haze_ * air));
  }

 private:
  Sight first(const Ray& ray) const {
    Sight nearest;
    if (ray.direction.z < 0) {
      const double t = (block_.base - ray.origin.z) / ray.direction.z;
      if (t > 0) nearest = {Sight::plain, t, {0, 0, 1}};
    }
    if (const auto hit = view_.ground.intersect(ray); hit && hit->t < nearest.t)
      nearest = {Sight::ground, hit->t, hit->normal};
    meet_sides(ray, nearest);
    return nearest;
  }

  /// The cut sides: four upright walls from the plain up to the ground at the rim.
  void meet_sides(const Ray& ray, Sight& nearest) const {
    const Vec3 o = ray.origin, d = ray.direction;
    const auto wall = [&](double t, Vec3 normal) {
      if (!(t > 0 && t < nearest.t)) return;
      Vec3 p = o + t * d;
      // Onto the rim exactly, so that it is not beside the terrain by rounding.
      if (normal.x != 0) p.x = normal.x > 0 ? block_.east : 0;
      if (normal.y != 0) p.y = normal.y > 0 ? 0 : -block_.south;
      const auto rim = view_.ground.height(p.x, p.y);
      if (rim && p.z < *rim && p.z > block_.base) nearest = {Sight::side, t, normal};
    };
    if (d.x != 0) {
      wall(-o.x / d.x, {-1, 0, 0});
      wall((block_.east - o.x) / d.x, {1, 0, 0});
    }
    if (d.y != 0) {
      wall(-o.y / d.y, {0, 1, 0});
      wall((-block_.south - o.y) / d.y, {0, -1, 0});
    }
  }

  bool in_shadow(Vec3 p) const {
    if (!shadows_) return false;
    const Ray to_sun{p, sun_};
    if (view_.ground.blocks(to_sun)) return true;
    Sight sight;
    meet_sides(to_sun, sight);
    return sight.what == Sight::side;
  }

  Light sky(Vec3 way) const {
    const double up = std::max(0.0, way.z);
    const Light air = mixed(kZenith, kHorizon, std::exp(-4 * up));
    const double near_sun = std::max(0.0, dot(way, sun_));
    return air + (0.25 * std::pow(near_sun, 24)) * Light{1, 0.9, 0.7};
  }

  /// Sun and sky on a matt surface that sees `open` of the sky.
  Light lit(Light albedo, Vec3 p, Vec3 normal, double open) const {
    const double slant = dot(normal, sun_);
    const double sun = slant > 0 && !in_shadow(p) ? slant : 0;
    const double sky = open * (0.6 + 0.4 * normal.z);
    return albedo * (sun * kSunlight + sky * kSkylight);
  }

  Light ground(Vec3 p, Vec3 facet) const {
    const double col = p.x / dem_.spacing.dx_m, row = -p.y / dem_.spacing.dy_m;
    const Vec3 normal = smooth_normal(col, row, facet);
    if (dot(facet, facet) == 0) return {};
    return lit(albedo_.at(p.z / view_.exaggeration), p + lift_ * facet, normal,
               sky_view_(col, row));
  }

  /// The normal between the four cells around, by the gradient of each that is known.
  Vec3 smooth_normal(double col, double row, Vec3 facet) const {
    const int c = std::clamp(int(col), 0, dem_.z.cols() - 2);
    const int r = std::clamp(int(row), 0, dem_.z.rows() - 2);
    const double u = col - c, v = row - r;
    double east = 0, south = 0, weights = 0;
    for (const auto& [dc, dr, weight] : {std::tuple{0, 0, (1 - u) * (1 - v)},
                                         {1, 0, u * (1 - v)},
                                         {0, 1, (1 - u) * v},
                                         {1, 1, u * v}}) {
      if (!dem_.known(c + dc, r + dr)) continue;
      const Gradient g = gradient_(c + dc, r + dr);
      east += weight * g.east, south += weight * g.south, weights += weight;
    }
    if (!(weights > 0)) return facet;
    const double e = view_.exaggeration / weights;
    return unit({-e * east, e * south, 1});
  }

  /// Cut earth, paler in layers towards the surface.
  Light side(Vec3 p, Vec3 normal) const {
    const double depth = (p.z - block_.base) / std::max(1e-9, block_.top - block_.base);
    return lit((0.75 + 0.5 * depth) * kEarth, p + lift_ * normal, normal, 0.9);
  }

  Light plain(Vec3 p) const {
    const bool inside = p.x > 0 && p.x < block_.east && p.y < 0 && p.y > -block_.south;
    if (inside) return 0.1 * kEarth;  // the bottom of a hole
    return lit(kPlain, p, {0, 0, 1}, 1);
  }

  const Dem& dem_;
  const View& view_;
  Block block_;
  bool shadows_;
  Vec3 sun_;
  GradientOf gradient_;
  Albedo albedo_;
  SkyView sky_view_;
  double clear_ = 0, haze_ = 0, lift_ = 0;
};

/// Where ray k of a pixel runs, in [0, 1) x [0, 1): an additive recurrence, which fills the square
/// evenly for any number of rays, turned round by a hash of the pixel. A single ray: the middle.
std::pair<double, double> sub_pixel(int k, int samples, int col, int row) {
  if (samples == 1) return {0.5, 0.5};
  const std::uint64_t bits = random_bits(0, 0, col, row);
  const double x = double(bits >> 40) / 16777216 + 0.7548776662466927 * k;
  const double y = double((bits >> 8) & 0xffffff) / 16777216 + 0.5698402909980532 * k;
  return {x - std::floor(x), y - std::floor(y)};
}

Rgb pixel(const Scene& scene, const Camera& camera, const ViewOptions& o, int col, int row) {
  Light sum{};
  for (int k = 0; k < o.samples; ++k) {
    const auto [dx, dy] = sub_pixel(k, o.samples, col, row);
    sum = sum + scene.seen(camera.ray(2 * (col + dx) / o.width - 1, 1 - 2 * (row + dy) / o.height));
  }
  sum = (1.0 / o.samples) * sum;
  const double threshold = double(random_bits(0, 1, col, row) >> 40) / 16777216;
  return {srgb(sum.x, threshold), srgb(sum.y, threshold), srgb(sum.z, threshold)};
}

}  // namespace

std::vector<Field> fields(ViewOptions& o) {
  return {{"width", o.width, {16, 16384}, "pixels", "of the picture"},
          {"height", o.height, {16, 16384}, "pixels", "of the picture"},
          {"samples", o.samples, {1, 256}, "", "rays for a pixel"},
          {"azimuth",
           o.azimuth_deg,
           {-360, 360},
           "degrees",
           "where the light comes from, clockwise from north"},
          {"altitude", o.altitude_deg, {0, 90}, "degrees", "height of the light over the horizon"},
          {"exaggeration",
           o.exaggeration,
           {0, 1000},
           "",
           "multiplies heights; 0: chosen, 1 with a camera"},
          {"heading",
           o.heading_deg,
           {-360, 360},
           "degrees",
           "where the three-quarter view looks, clockwise from north"},
          {"tilt", o.tilt_deg, {1, 90}, "degrees", "how far down the three-quarter view looks"},
          {"fov", o.fov_deg, {1, 150}, "degrees", "angle across the picture's width"},
          {"haze", o.haze, {0, 100}, "", "of the air; 0: clear"},
          {"shadows", o.shadows, "shadows of the sun"},
          {"palette", o.palette, palette_names(), "colours by height"},
          {"sea", o.sea, "heights at or below 0 m are water"}};
}

View make_view(const Dem& dem, const ViewOptions& options) {
  check_options(options);
  check_shape(dem);
  if (options.target && !options.camera)
    throw std::invalid_argument("target without a camera; must have both, or the camera alone");
  double exaggeration = options.exaggeration;
  if (exaggeration == 0) exaggeration = options.camera ? 1 : chosen_exaggeration(dem);
  Heightfield ground(dem, exaggeration);
  const Block block = block_of(ground);
  const Camera camera = options.camera ? own_camera(ground, block, exaggeration, options)
                                       : three_quarter_camera(block, options);
  return {exaggeration, std::move(ground), camera};
}

Raster<Rgb> render_view(const Dem& dem, const ViewOptions& options, const Run& run) {
  return with_threads(run.threads, [&] {
    const View view = make_view(dem, options);
    const Scene scene(dem, view, options, run.part(0, 0.1));
    Raster<Rgb> picture({options.width, options.height});
    constexpr int rows_at_once = 16;
    for (int first = 0; first < options.height; first += rows_at_once) {
      run.report(0.1 + 0.9 * first / options.height, "trace rays");
      parallel_for(first, std::min(first + rows_at_once, options.height), 1, [&](int row) {
        for (int col = 0; col < options.width; ++col)
          picture(col, row) = pixel(scene, view.camera, options, col, row);
      });
    }
    return picture;
  });
}

}  // namespace dem
