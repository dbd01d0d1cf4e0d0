#include "dem/raytrace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "numeric/random.h"

#ifdef DEM_EMBREE
#include <embree3/rtcore.h>
#endif

namespace dem {
using namespace numeric;
namespace {

double length(Vec3 v) { return std::sqrt(dot(v, v)); }
Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3 at(const Ray& ray, double t) { return ray.origin + t * ray.direction; }

/// A DEM from a function of metres east and north of the middle of the raster.
Dem surface(Size size, Spacing cell, const std::function<double(double, double)>& z) {
  Dem dem{Raster<float>(size), Mask(size, 1), {}, cell};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      dem.z(col, row) = float(
          z((col - (size.cols - 1) / 2.0) * cell.dx_m, ((size.rows - 1) / 2.0 - row) * cell.dy_m));
  return dem;
}

/// Random whole heights from 0 to `high`: as rough as can be, and exact in single precision.
Dem rough(Size size, int high, std::uint64_t seed, Spacing cell = {1, 1}) {
  Dem dem{Raster<float>(size), Mask(size, 1), {}, cell};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      dem.z(col, row) = float(below(random_bits(seed, 0, col, row), std::uint64_t(high) + 1));
  return dem;
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : sequence_(seed) {}
  double in(double low, double high) {
    return low + (high - low) * 0.5 * (1 + signed_uniform(sequence_.bits()));
  }
  int below(int n) { return int(sequence_.below(std::uint64_t(n))); }

 private:
  Sequence sequence_;
};

/// The kinds of rays that break ray tracers. `w` and `h`: extent of the field; `top`: its height.
struct Kind {
  const char* name;
  Ray (*make)(Random&, int w, int h, double top);
};
const Kind kKinds[] = {
    {"from outside to a point inside",
     [](Random& r, int w, int h, double top) {
       const Vec3 o{r.in(-w, 2 * w), r.in(-2 * h, h), r.in(-top, 4 * top)};
       const Vec3 to{r.in(0, w), r.in(-h, 0), r.in(0, top)};
       return Ray{o, to - o};
     }},
    {"from inside the bounds",
     [](Random& r, int w, int h, double top) {
       return Ray{{r.in(0, w), r.in(-h, 0), r.in(0, top)}, {r.in(-1, 1), r.in(-1, 1), r.in(-1, 1)}};
     }},
    {"vertical",
     [](Random& r, int w, int h, double top) {
       const bool down = r.below(2) == 0;
       return Ray{{r.in(0, w), r.in(-h, 0), down ? 2 * top : -top}, {0, 0, down ? -1.0 : 1.0}};
     }},
    {"along a grid line",
     [](Random& r, int w, int h, double top) {
       const Vec3 o{-1, -double(r.below(h + 1)), r.in(0, 2 * top)};
       const double down = r.in(-top, top) / w;
       if (r.below(2)) return Ray{o, {1, 0, down}};
       return Ray{{double(r.below(w + 1)), 1, o.z}, {0, -1, down}};
     }},
    {"grazing",
     [](Random& r, int w, int h, double top) {
       const Vec3 o{-double(w), r.in(-2 * h, h), top * r.in(0.7, 1.1)};
       return Ray{o, {1, r.in(-0.5, 0.5), r.in(-0.02, 0.01) * top / w}};
     }},
    {"along the diagonals",
     [](Random& r, int w, int h, double top) {
       const int k = r.below(std::min(w, h));
       return Ray{{double(k) - 1, 1, r.in(top / 2, 2 * top)},
                  {1, r.below(4) ? -1.0 : -0.5, -r.in(0, 2) * top / w}};
     }},
};

struct Triangle {
  std::array<Vec3, 3> corners;
};

/// The triangles of a DEM as raytrace.h promises them.
std::vector<Triangle> triangles(const Dem& dem) {
  std::vector<Triangle> all;
  const auto point = [&](int c, int r) {
    return Vec3{c * dem.spacing.dx_m, -r * dem.spacing.dy_m, double(dem.z(c, r))};
  };
  for (int r = 0; r + 1 < dem.z.rows(); ++r)
    for (int c = 0; c + 1 < dem.z.cols(); ++c) {
      const bool a = dem.known(c, r), b = dem.known(c + 1, r), d = dem.known(c, r + 1),
                 e = dem.known(c + 1, r + 1);
      const Vec3 A = point(c, r), B = point(c + 1, r), D = point(c, r + 1), E = point(c + 1, r + 1);
      if (a && e) {
        if (b) all.push_back({{A, E, B}});
        if (d) all.push_back({{A, D, E}});
      } else if (b && d) {
        if (a) all.push_back({{A, D, B}});
        if (e) all.push_back({{B, D, E}});
      }
    }
  return all;
}

/// Every triangle asked in turn; `slack` widens each by that share of itself.
std::optional<double> ask_all(const std::vector<Triangle>& all, const Ray& ray, double slack) {
  std::optional<double> nearest;
  for (const auto& [p] : all) {
    const Vec3 n = cross(p[1] - p[0], p[2] - p[0]);
    const double slope = dot(n, ray.direction);
    if (std::abs(slope) < 1e-12) continue;
    const double t = dot(n, p[0] - ray.origin) / slope;
    if (t < -slack || t > ray.t_max) continue;
    const Vec3 q = at(ray, t);
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k)
      inside &= dot(n, cross(p[(k + 1) % 3] - p[k], q - p[k])) >= -slack * dot(n, n);
    if (inside && (!nearest || t < *nearest)) nearest = t;
  }
  return nearest;
}

bool same(std::optional<double> a, std::optional<double> b, double tolerance) {
  return a.has_value() == b.has_value() && (!a || std::abs(*a - *b) <= tolerance * (1 + *a));
}

std::string text(const Ray& r, std::optional<double> got, std::optional<double> expected) {
  const auto number = [](std::optional<double> t) { return t ? std::to_string(*t) : "none"; };
  return ::testing::PrintToString(std::array{r.origin.x, r.origin.y, r.origin.z, r.direction.x,
                                             r.direction.y, r.direction.z}) +
         ": " + number(got) + ", must be " + number(expected);
}

std::optional<double> distance(const Heightfield& field, const Ray& ray) {
  const auto hit = field.intersect(ray);
  return hit ? std::optional(hit->t) : std::nullopt;
}

/// Whether an answer is right up to rounding: the oracle gives it to a ray a hair beside.
bool explained(std::optional<double> got, const Ray& ray, double hair, double tolerance,
               const std::function<std::optional<double>(const Ray&)>& oracle) {
  for (const Vec3 v : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {1, -1, 0}})
    for (const double sign : {-hair, hair}) {
      Ray beside = ray;
      beside.origin = ray.origin + sign * v;
      if (same(got, oracle(beside), tolerance)) return true;
    }
  return false;
}

void punch_holes(Dem& dem, std::uint64_t seed) {
  for (int row = 0; row < dem.z.rows(); ++row)
    for (int col = 0; col < dem.z.cols(); ++col)
      if (below(random_bits(seed, 1, col, row), 6) == 0) dem.known(col, row) = 0;
}

TEST(Heightfield, MeetsAPlaneWhereItsEquationSays) {
  // z = 40 + 0.3 x - 0.2 y on cells that are not square.
  const auto z = [](double x, double y) { return 40 + 0.3 * x - 0.2 * y; };
  const Spacing cell{2, 3};
  const Dem dem = surface({33, 21}, cell, z);
  const Heightfield field(dem);
  const double east = 16 * cell.dx_m, north = -10 * cell.dy_m;  // the middle
  const Vec3 normal = (1 / std::sqrt(1.13)) * Vec3{-0.3, 0.2, 1};
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 to{random.in(1, 63), random.in(-59, -1), 0};
    const Vec3 on{to.x, to.y, z(to.x - east, to.y - north)};
    const Vec3 from{random.in(-100, 160), random.in(-160, 100), random.in(90, 200)};
    const auto hit = field.intersect({from, on - from});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 1, 3e-6);  // heights are float32: 4e-6 m of 40 m, seen at a slant
    EXPECT_NEAR(length(hit->normal - normal), 0, 1e-5);
    EXPECT_EQ(hit->col, std::min(int(to.x / 2), 31));
    EXPECT_EQ(hit->row, std::min(int(-to.y / 3), 19));
  }
}

TEST(Heightfield, MeetsAPyramidWhereItsFacesSay) {
  // |x| + |y| + z = 20: four planes whose edges are grid lines.
  const Dem dem =
      surface({41, 41}, {1, 1}, [](double x, double y) { return 20 - std::abs(x) - std::abs(y); });
  const Heightfield field(dem);
  Random random(2);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 from{random.in(-60, 60), random.in(-60, 60), random.in(21, 60)};
    const Vec3 to{random.in(-20, 20), random.in(-20, 20), random.in(-20, 0)};
    double first = 2;  // the nearest of the faces' planes that is met on its own face
    for (const double sx : {-1.0, 1.0})
      for (const double sy : {-1.0, 1.0}) {
        const Vec3 n{sx, sy, 1};
        const double t = (20 - dot(n, from)) / dot(n, to - from);
        const Vec3 p = from + t * (to - from);
        if (t > 0 && sx * p.x >= 0 && sy * p.y >= 0) first = std::min(first, t);
      }
    const auto hit = field.intersect({from + Vec3{20, -20, 0}, to - from});
    const Vec3 p = from + first * (to - from);
    const bool on = first <= 2 && std::max(std::abs(p.x), std::abs(p.y)) <= 20;
    ASSERT_EQ(hit.has_value(), on);
    if (hit) {
      EXPECT_NEAR(hit->t, first, 1e-9);
    }
  }
}

TEST(Heightfield, MeetsASphericalCapWithinTheSagOfItsTriangles) {
  const double radius = 100;
  const Dem dem = surface({81, 81}, {1, 1}, [&](double x, double y) {
    return std::sqrt(radius * radius - x * x - y * y);
  });
  const Heightfield field(dem);
  // A chord of length sqrt(2) sags by at most its square over 8 radii of curvature; seen at a slant
  // of at least 30 degrees, twice that along the ray. Curvature in z grows with the slope: times 2.
  const double sag = 2.0 / (8 * radius) * 2 * 2;
  Random random(3);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 on{random.in(-38, 38), random.in(-38, 38), 0};
    const Vec3 p{on.x, on.y, std::sqrt(radius * radius - on.x * on.x - on.y * on.y)};
    const Vec3 from = p + Vec3{random.in(-80, 80), random.in(-80, 80), random.in(20, 150)};
    const Vec3 way = (1 / length(p - from)) * (p - from);
    if (dot(way, (1 / radius) * p) > -0.5) continue;
    ++hits;
    const auto hit = field.intersect({from + Vec3{40, -40, 0}, way});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, length(p - from), sag);
  }
  EXPECT_GT(hits, 1000);
}

TEST(Heightfield, FindsWhatAskingEveryTriangleFinds) {
  for (const bool holes : {false, true}) {
    Dem dem = rough({19, 14}, 8, 4, {1, 1});
    if (holes) punch_holes(dem, 4);
    const Heightfield field(dem);
    const auto all = triangles(dem);
    const auto oracle = [&](const Ray& ray) { return ask_all(all, ray, 0); };
    for (const auto& kind : kKinds) {
      Random random(5);
      int hits = 0;
      for (int i = 0; i < 2000; ++i) {
        const Ray ray = kind.make(random, 18, 13, 8);
        const auto got = distance(field, ray), expected = ask_all(all, ray, 1e-12);
        hits += got.has_value();
        EXPECT_EQ(field.blocks(ray), got.has_value());
        // Rays exactly along an edge beside a hole may pass or not; a hair beside tells.
        if (!same(got, expected, 1e-9)) {
          EXPECT_TRUE(explained(got, ray, 1e-9, 1e-6, oracle))
              << kind.name << (holes ? ", holes: " : ": ") << text(ray, got, expected);
        }
      }
      EXPECT_GT(hits, 200) << kind.name;
    }
  }
}

TEST(Heightfield, LetsNoRayThroughAtCornersEdgesAndDiagonals) {
  // From above, to points on the lines of the mesh, a nanometre down so that no ray may graze them.
  const Dem dem = rough({34, 23}, 50, 6);
  const Heightfield field(dem);
  Random random(7);
  for (int row = 0; row < 23; ++row)
    for (int col = 0; col < 34; ++col)
      for (const auto& [dc, dr] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        if (col + dc >= 34 || row + dr >= 23) continue;
        const double share = (dc || dr) ? random.in(0, 1) : 0;
        const double z =
            double(dem.z(col, row)) + share * double(dem.z(col + dc, row + dr) - dem.z(col, row));
        const Vec3 to{col + share * dc, -row - share * dr, z};
        const Vec3 from{double(random.below(34)), -double(random.below(23)), 70};
        const auto hit = field.intersect({from, to - Vec3{0, 0, 1e-9} - from});
        const bool rim = (to.x <= 0 || to.x >= 33 || to.y >= 0 || to.y <= -22);
        if (rim && !hit) continue;  // beside the terrain by rounding
        ASSERT_TRUE(hit) << col << " " << row;
        EXPECT_LE(hit->t, 1);
        const auto from_above = field.intersect({{to.x, to.y, 99}, {0, 0, -1}});
        ASSERT_TRUE(from_above);
        EXPECT_NEAR(99 - from_above->t, z, 1e-9);
      }
}

TEST(Heightfield, ALevelPlainIsMetFromAnyHeight) {
  // The lid and the floor of the terrain are one plane: rounding must not open it.
  const Dem dem = surface({65, 65}, {30, 30}, [](double, double) { return 0.1; });
  const Heightfield field(dem);
  Random random(8);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 from{random.in(-1e6, 1e6), random.in(-1e6, 1e6), random.in(1, 1e6)};
    const Vec3 to{random.in(1, 1900), random.in(-1900, -1), 0.1};
    EXPECT_TRUE(field.blocks({from, to - from}));
    EXPECT_TRUE(
        field.blocks({{from.x, from.y, -from.z}, {to.x - from.x, to.y - from.y, from.z + 0.1}}));
  }
}

TEST(Heightfield, RaysPassThroughHolesAndThreeCornersKeepTheirTriangle) {
  Dem dem = surface({5, 5}, {1, 1}, [](double, double) { return 1; });
  dem.known(2, 2) = 0;
  dem.z(2, 2) = -9999;
  const Heightfield field(dem);
  const auto down = [&](double x, double y) { return field.blocks({{x, y, 5}, {0, 0, -1}}); };
  EXPECT_EQ(field.low(), 1);
  EXPECT_FALSE(down(2, -2));
  for (const auto& [x, y] : {std::pair{1.7, -1.8}, {2.3, -1.8}, {1.7, -2.2}, {2.3, -2.2}}) {
    EXPECT_FALSE(down(x, y)) << x << " " << y;
    EXPECT_FALSE(field.height(x, y));
  }
  for (const auto& [x, y] : {std::pair{1.3, -1.2}, {2.7, -1.2}, {1.3, -2.8}, {2.7, -2.8}}) {
    EXPECT_TRUE(down(x, y)) << x << " " << y;
    EXPECT_EQ(field.height(x, y), 1);
  }
  dem.known = Mask({5, 5}, 0);
  const Heightfield nothing(dem);
  EXPECT_FALSE(nothing.blocks({{2, -2, 5}, {0, 0.1, -1}}));
  EXPECT_GT(nothing.low(), nothing.high());
}

TEST(Heightfield, HitsFromBelow) {
  const Dem dem = rough({9, 9}, 5, 9);
  const Heightfield field(dem);
  const auto up = field.intersect({{4.25, -4.5, -10}, {0, 0, 2}});
  const auto down = field.intersect({{4.25, -4.5, 10}, {0, 0, -2}});
  ASSERT_TRUE(up && down);
  EXPECT_NEAR(-10 + 2 * up->t, 10 - 2 * down->t, 1e-12);
  EXPECT_EQ(up->normal, down->normal);
  EXPECT_NEAR(*field.height(4.25, -4.5), 10 - 2 * down->t, 1e-12);
}

TEST(Heightfield, ARayEndsAtItsEnd) {
  const Dem dem = surface({5, 5}, {1, 1}, [](double, double) { return 0; });
  const Heightfield field(dem);
  const Ray down{{2.2, -2.1, 10}, {0, 0, -1}};
  EXPECT_TRUE(field.blocks({down.origin, down.direction, 10.5}));
  EXPECT_FALSE(field.blocks({down.origin, down.direction, 9.5}));
  EXPECT_FALSE(field.blocks({down.origin, {0, 0, 1}}));
  EXPECT_FALSE(field.blocks({down.origin, {0, 0, 0}}));
  EXPECT_FALSE(field.blocks({down.origin, {0, 0, -INFINITY}}));
  EXPECT_FALSE(field.blocks({{2, NAN, 10}, down.direction}));
}

TEST(Heightfield, ExaggerationMultipliesHeights) {
  const Dem dem = rough({9, 7}, 5, 10);
  Dem high = dem;
  for (auto& z : high.z.cells()) z *= 3;
  const Heightfield a(dem, 3), b(high);
  EXPECT_EQ(a.high(), b.high());
  EXPECT_EQ(a.height(3.3, -2.2), b.height(3.3, -2.2));
}

TEST(Heightfield, RefusesWhatIsNoSurface) {
  using ::testing::HasSubstr;
  using ::testing::ThrowsMessage;
  const auto make = [](Size size, Spacing cell, double exaggeration) {
    return [=] { Heightfield(Dem{Raster<float>(size), Mask(size, 1), {}, cell}, exaggeration); };
  };
  EXPECT_THAT(make({1, 9}, {1, 1}, 1), ThrowsMessage<std::invalid_argument>(HasSubstr(
                                           "dem is 1 x 9 cells; must be at least 2 x 2")));
  EXPECT_THAT(make({2, 2}, {0, 1}, 1), ThrowsMessage<std::invalid_argument>(HasSubstr("spacing")));
  EXPECT_THAT(make({2, 2}, {1, 1}, 0),
              ThrowsMessage<std::invalid_argument>(HasSubstr("exaggeration = 0")));
  Dem dem = rough({3, 3}, 5, 11);
  dem.z(2, 1) = NAN;
  EXPECT_THAT([&] { Heightfield field(dem); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("z(2, 1) = nan")));
  dem.known(2, 1) = 0;
  EXPECT_NO_THROW(Heightfield field(dem));
}

ViewOptions small_picture(std::optional<Vec3> camera = {}, std::optional<Vec3> target = {}) {
  ViewOptions o;
  o.width = 64, o.height = 48;
  o.camera = camera, o.target = target;
  return o;
}

/// A map of a view: the camera far over the middle of the DEM, north up.
ViewOptions from_above(const Dem& dem) {
  const double east = (dem.z.cols() - 1) * dem.spacing.dx_m / 2;
  const double south = (dem.z.rows() - 1) * dem.spacing.dy_m / 2;
  ViewOptions o = small_picture(Vec3{east, -south, 10 * east}, Vec3{east, -south, 0});
  o.width = o.height = 64, o.fov_deg = 11, o.haze = 0;
  return o;
}

int brightness(const Rgb& c) { return int(c[0]) + int(c[1]) + int(c[2]); }

TEST(RenderView, ThreadsChangeNothing) {
  Dem dem = rough({70, 50}, 200, 20, {30, 40});
  dem.known(20, 20) = 0;
  EXPECT_EQ(render_view(dem, small_picture(), {.threads = 1, .progress = {}}),
            render_view(dem, small_picture(), {.threads = 4, .progress = {}}));
}

TEST(RenderView, TheThreeQuarterViewHasTheWholeTerrainInThePicture) {
  for (const Size size : {Size{50, 50}, {200, 20}, {9, 120}})
    for (const double heading : {0.0, 25.0, 200.0})
      for (const double tilt : {5.0, 32.0, 90.0}) {
        const Dem dem = rough(size, 300, 21, {30, 40});
        ViewOptions o = small_picture();
        o.heading_deg = heading, o.tilt_deg = tilt;
        const View view = make_view(dem, o);
        const auto& [position, forward, right, up] = view.camera;
        double nearest = 0;
        for (const double x : {0.0, (size.cols - 1) * 30.0})
          for (const double y : {0.0, -(size.rows - 1) * 40.0})
            for (const double z : {view.ground.low(), view.ground.high()}) {
              const Vec3 p = Vec3{x, y, z} - position;
              const double depth = dot(p, forward);
              ASSERT_GT(depth, 0);
              const double at_x = std::abs(dot(p, right) / dot(right, right) / depth);
              const double at_y = std::abs(dot(p, up) / dot(up, up) / depth);
              EXPECT_LE(std::max(at_x, at_y), 1);
              nearest = std::max({nearest, at_x, at_y});
            }
        EXPECT_GT(nearest, 0.6);  // and it fills it
      }
}

TEST(RenderView, NorthIsUpAndEastIsRightFromAbove) {
  Dem dem =
      surface({41, 41}, {10, 10}, [](double x, double y) { return x > 50 && y > 50 ? 5 : -5; });
  ViewOptions o = from_above(dem);
  o.sea = true, o.shadows = false;
  const auto picture = render_view(dem, o);
  const auto is_water = [&](int col, int row) {
    return picture(col, row)[2] > picture(col, row)[0];
  };
  EXPECT_FALSE(is_water(50, 12));
  EXPECT_TRUE(is_water(12, 12));
  EXPECT_TRUE(is_water(50, 50));
  EXPECT_TRUE(is_water(12, 50));
}

TEST(RenderView, TheCameraLooksAtItsTarget) {
  const Dem dem = rough({30, 30}, 10, 22, {10, 10});
  const Vec3 target{120, -80, 7};
  const View view = make_view(dem, small_picture(Vec3{-100, -400, 300}, target));
  const Ray ray = view.camera.ray(0, 0);
  EXPECT_NEAR(length(at(ray, length(target - ray.origin)) - target), 0, 1e-9);
  EXPECT_EQ(view.exaggeration, 1);
  EXPECT_NEAR(length(view.camera.right), std::tan(16 * 3.14159265358979 / 180), 1e-12);
}

TEST(RenderView, ARidgeThrowsAShadowAwayFromTheSun) {
  const Dem dem =
      surface({81, 81}, {10, 10}, [](double x, double) { return x > -10 && x < 10 ? 100 : 0; });
  ViewOptions o = from_above(dem);
  o.azimuth_deg = 270, o.altitude_deg = 30;  // the shadow is 173 m long: 14 pixels
  const auto lit = render_view(dem, o);
  o.shadows = false;
  const auto plain = render_view(dem, o);
  EXPECT_LT(brightness(lit(40, 32)), brightness(plain(40, 32)) - 60);
  EXPECT_EQ(lit(20, 32), plain(20, 32));
  EXPECT_EQ(lit(52, 32), plain(52, 32));
}

TEST(RenderView, AboveTheHorizonIsSkyAndHazeHidesTheGround) {
  const Dem dem = rough({30, 30}, 10, 23, {10, 10});
  ViewOptions up = small_picture(Vec3{150, -150, 100}, Vec3{150, 100, 300});
  const auto sky = render_view(dem, up);
  for (const auto& c : sky.cells()) EXPECT_GT(c[2], c[0]);
  ViewOptions clear = small_picture(Vec3{150, -290, 40}, Vec3{150, 0, 0});
  ViewOptions thick = clear;
  clear.haze = 0, thick.haze = 100;
  const auto ground = render_view(dem, clear), fog = render_view(dem, thick);
  EXPECT_GT(brightness(fog(32, 24)), brightness(ground(32, 24)));
  EXPECT_GT(fog(32, 24)[2], fog(32, 24)[0]);
}

TEST(RenderView, HolesAreDark) {
  Dem dem = surface({41, 41}, {10, 10}, [](double, double) { return 50; });
  for (int row = 10; row < 30; ++row)
    for (int col = 10; col < 30; ++col) dem.known(col, row) = 0;
  const auto picture = render_view(dem, from_above(dem));
  EXPECT_LT(brightness(picture(32, 32)), brightness(picture(8, 32)) / 2);
  dem.known = Mask(dem.size(), 0);
  EXPECT_NO_THROW(render_view(dem, small_picture()));
}

TEST(RenderView, MoreRaysForAPixelSoftenEdgesAndKeepTheMean) {
  const Dem dem =
      surface({41, 41}, {10, 10}, [](double x, double y) { return x + 2 * y > 0 ? 9 : -9; });
  ViewOptions o = from_above(dem);
  o.sea = true, o.shadows = false;
  const auto tones = [&](int samples) {
    o.samples = samples;
    std::vector<Rgb> all;
    long sum = 0;
    const auto picture = render_view(dem, o);
    for (const auto& c : picture.cells()) all.push_back(c), sum += brightness(c);
    std::ranges::sort(all);
    return std::pair{int(std::unique(all.begin(), all.end()) - all.begin()), sum / 4096};
  };
  const auto [few, mean] = tones(1);
  const auto [many, same_mean] = tones(16);
  EXPECT_GT(many, few);
  EXPECT_NEAR(double(mean), double(same_mean), 6);
}

TEST(RenderView, ExaggerationIsChosenByTheRelief) {
  const auto chosen = [](double high) {
    const Dem dem =
        surface({101, 51}, {10, 10}, [&](double x, double) { return x > 0 ? high : 0; });
    return make_view(dem, small_picture()).exaggeration;
  };
  EXPECT_EQ(chosen(0), 1);
  EXPECT_EQ(chosen(500), 1);
  EXPECT_EQ(chosen(20), 4);  // 1010 m / 12 / 20 m = 4.2
}

TEST(RenderView, StopsWhenAskedTo) {
  const Dem dem = rough({30, 30}, 10, 24);
  EXPECT_THROW(render_view(dem, small_picture(),
                           {.threads = 1, .progress = [](double p, auto) { return p < 0.5; }}),
               Cancelled);
}

TEST(RenderView, RefusesACameraThatSeesNothing) {
  using ::testing::HasSubstr;
  using ::testing::ThrowsMessage;
  const Dem dem = surface({11, 11}, {10, 10}, [](double, double) { return 400; });
  const auto view = [&](std::optional<Vec3> camera, std::optional<Vec3> target) {
    return [=, &dem] { make_view(dem, small_picture(camera, target)); };
  };
  const auto says = [](const char* words) {
    return ThrowsMessage<std::invalid_argument>(HasSubstr(words));
  };
  EXPECT_THAT(view(Vec3{50, -50, 100}, {}),
              says("camera is 300.0 m under the ground; must be higher than 400.0 m here"));
  EXPECT_THAT(view(Vec3{-500, -50, -100}, {}), says("camera is at -100.0 m, under all ground"));
  EXPECT_THAT(view(Vec3{50, -50, 500}, Vec3{50, -50, 500}), says("camera stands on its target"));
  EXPECT_THAT(view({}, Vec3{50, -50, 500}), says("target without a camera"));
  EXPECT_THAT(view(Vec3{50, NAN, 500}, {}), says("must be finite"));
  EXPECT_NO_THROW(view(Vec3{50, -50, 401}, {})());
  ViewOptions wide = small_picture();
  wide.fov_deg = 180;
  EXPECT_THAT([&] { make_view(dem, wide); }, says("fov = 180; must be"));
}

#ifdef DEM_EMBREE
/// The same triangles in Embree.
class Embree {
 public:
  explicit Embree(const std::vector<Triangle>& all) : device_(rtcNewDevice("threads=1")) {
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const auto mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * all.size()));
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), all.size()));
    unsigned n = 0;
    for (const auto& triangle : all)
      for (const Vec3& p : triangle.corners) {
        *points++ = float(p.x), *points++ = float(p.y), *points++ = float(p.z);
        *corners++ = n++;
      }
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene_);
  }
  ~Embree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  std::optional<double> distance(const Ray& ray) const {
    RTCRayHit r{};
    r.ray.org_x = float(ray.origin.x), r.ray.org_y = float(ray.origin.y);
    r.ray.org_z = float(ray.origin.z), r.ray.dir_x = float(ray.direction.x);
    r.ray.dir_y = float(ray.direction.y), r.ray.dir_z = float(ray.direction.z);
    r.ray.tfar = std::numeric_limits<float>::infinity();
    r.ray.mask = ~0u;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return double(r.ray.tfar);
  }

 private:
  RTCDevice device_;
  RTCScene scene_ = nullptr;
};

TEST(Heightfield, FindsWhatEmbreeFinds) {
  for (const bool holes : {false, true}) {
    Dem dem = rough({129, 97}, 40, 12);
    if (holes) punch_holes(dem, 12);
    const Heightfield field(dem);
    const Embree embree(triangles(dem));
    const auto ours = [&](const Ray& ray) { return distance(field, ray); };
    const auto theirs = [&](const Ray& ray) { return embree.distance(ray); };
    for (const auto& kind : kKinds) {
      Random random(13);
      for (int i = 0; i < 20000; ++i) {
        Ray ray = kind.make(random, 128, 96, 40);
        for (double* x : {&ray.origin.x, &ray.origin.y, &ray.origin.z, &ray.direction.x,
                          &ray.direction.y, &ray.direction.z})
          *x = double(float(*x));  // the same ray for both
        const auto got = ours(ray), expected = theirs(ray);
        // Single precision: a ray that grazes an edge may go either way, as ours a hair beside.
        if (!same(got, expected, 1e-4)) {
          EXPECT_TRUE(explained(expected, ray, 2e-4, 2e-3, ours) ||
                      explained(got, ray, 2e-4, 2e-3, theirs))
              << kind.name << (holes ? ", holes: " : ": ") << text(ray, got, expected);
        }
      }
    }
  }
}
#else
TEST(Heightfield, FindsWhatEmbreeFinds) {
  GTEST_SKIP() << "Embree 3 was not there when this was built; Debian has it as libembree-dev";
}
#endif

}  // namespace
}  // namespace dem
