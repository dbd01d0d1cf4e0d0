// Grid tracing. Inside, a ray runs in columns, rows and metres: a square is then 1 x 1, and a plane
// of the DDA a whole number.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dem/raytrace.h"
#include "numeric/parallel.h"

namespace dem {
using namespace numeric;
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// A grid has 4 x 4 parts: 1 << kShift along each side.
constexpr int kShift = 2;
constexpr int kPartsMinus1 = (1 << kShift) - 1;

/// The corners of one square. Its diagonal runs from a to e; where a or e is unknown the square is
/// mirrored first, so that three known corners make a triangle whichever they are.
///
///   a - b    u = 0 to 1 from a to b, v = 0 to 1 from a to d
///   | \ |    upper triangle a b e, where u > v
///   d - e    lower triangle a d e, where u < v
struct Square {
  double a, b, d, e;
  bool mirrored;

  Square(double nw, double ne, double sw, double se)
      : a(nw), b(ne), d(sw), e(se), mirrored(std::isnan(nw - se)) {
    if (mirrored) std::swap(a, b), std::swap(d, e);
  }

  double along_u(bool upper) const { return upper ? b - a : e - d; }
  double along_v(bool upper) const { return upper ? e - b : d - a; }
  double height(bool upper, double u, double v) const {
    return a + along_u(upper) * u + along_v(upper) * v;
  }
};

/// The part of [from, to] where lo <= origin + t * direction <= hi. False when there is none.
bool clip(double origin, double direction, double lo, double hi, double& from, double& to) {
  if (direction == 0) return origin >= lo && origin <= hi;
  const double t0 = (lo - origin) / direction, t1 = (hi - origin) / direction;
  from = std::max(from, std::min(t0, t1));
  to = std::min(to, std::max(t0, t1));
  return from <= to;
}

void check(const Dem& dem, double exaggeration) {
  check_shape(dem);
  if (dem.z.cols() < 2 || dem.z.rows() < 2)
    throw std::invalid_argument(
        fmt::format("dem is {} x {} cells; must be at least 2 x 2", dem.z.cols(), dem.z.rows()));
  const auto [dx, dy] = dem.spacing;
  if (!(dx > 0 && dy > 0 && std::isfinite(dx) && std::isfinite(dy)))
    throw std::invalid_argument(fmt::format("spacing = {} x {} m; must be > 0", dx, dy));
  if (!(exaggeration > 0 && std::isfinite(exaggeration)))
    throw std::invalid_argument(fmt::format("exaggeration = {}; must be > 0", exaggeration));
}

}  // namespace

/// A ray on its way through the grid, and the hit it ends with.
struct Heightfield::Walk {
  double x, y, z, dx, dy, dz;  // in columns, rows and metres
  double from, to;             // the part of the ray above or below the squares
  int side = 0;                // 1: above ground at the last point seen, -1: below, 0: not known

  double t = 0;
  int col = 0, row = 0;
  double east = 0, south = 0;  // slope of the triangle, metres per cell

  double x_at(double t_) const { return x + t_ * dx; }
  double y_at(double t_) const { return y + t_ * dy; }
  double z_at(double t_) const { return z + t_ * dz; }

  /// Whether the ray meets one triangle between t0 and t1: there its height above the plane of the
  /// triangle is linear in t.
  bool meets(const Square& s, bool upper, int c, int r, double t0, double t1) {
    const auto above = [&](double t_) {
      const double u = x_at(t_) - c;
      return z_at(t_) - s.height(upper, s.mirrored ? 1 - u : u, y_at(t_) - r);
    };
    const double above0 = above(t0), above1 = above(t1);
    if (std::isnan(above0)) {
      side = 0;
      return false;
    }
    if (above0 * side < 0 || above0 == 0) {
      t = t0;
    } else if (above0 * above1 <= 0) {
      t = t0 + (t1 - t0) * (above0 / (above0 - above1));
    } else {
      side = above1 > 0 ? 1 : -1;
      return false;
    }
    col = c, row = r;
    east = s.mirrored ? -s.along_u(upper) : s.along_u(upper);
    south = s.along_v(upper);
    return true;
  }

  /// Whether the ray meets one square, which it crosses between t0 and t1.
  bool meets(const Square& s, int c, int r, double t0, double t1) {
    const auto off_diagonal = [&](double t_) {
      const double u = x_at(t_) - c;
      return (s.mirrored ? 1 - u : u) - (y_at(t_) - r);
    };
    const double off0 = off_diagonal(t0), off1 = off_diagonal(t1);
    if (off0 * off1 >= 0) return meets(s, off0 + off1 > 0, c, r, t0, t1);
    const double middle = std::clamp(t0 + (t1 - t0) * (off0 / (off0 - off1)), t0, t1);
    return meets(s, off0 > 0, c, r, t0, middle) || meets(s, off0 < 0, c, r, middle, t1);
  }
};

Heightfield::Heightfield(const Dem& dem, double exaggeration) : spacing_(dem.spacing) {
  check(dem, exaggeration);
  z_ = Raster<float>(dem.size());
  for (int row = 0; row < z_.rows(); ++row)
    for (int col = 0; col < z_.cols(); ++col) {
      const bool known = dem.known(col, row) != 0;
      if (known && !std::isfinite(dem.z(col, row)))
        throw std::invalid_argument(fmt::format("z({}, {}) = {}; a known height must be finite",
                                                col, row, dem.z(col, row)));
      z_(col, row) = known ? float(exaggeration * double(dem.z(col, row))) : kUnknown;
      has_holes_ |= !known;
    }
  build_tree();
}

void Heightfield::build_tree() {
  // The lowest grids, from the corners of those of their squares that have a triangle.
  const auto parts = [](int n) { return (n + kPartsMinus1) >> kShift; };
  tree_.emplace_back(Size{parts(z_.cols() - 1), parts(z_.rows() - 1)});
  const auto of_squares = [&](int i, int j) {
    Bounds bounds;
    const auto last = [](int k, int end) { return std::min((k + 1) << kShift, end); };
    for (int r = j << kShift; r < last(j, z_.rows() - 1); ++r)
      for (int c = i << kShift; c < last(i, z_.cols() - 1); ++c) {
        const float corners[] = {z_(c, r), z_(c + 1, r), z_(c, r + 1), z_(c + 1, r + 1)};
        if (std::ranges::count_if(corners, [](float z) { return std::isnan(z); }) > 1) continue;
        for (const float z : corners) {
          if (z < bounds.low) bounds.low = z;
          if (z > bounds.high) bounds.high = z;
        }
      }
    return bounds;
  };
  parallel_for(0, tree_[0].rows(), 4, [&](int j) {
    for (int i = 0; i < tree_[0].cols(); ++i) tree_[0](i, j) = of_squares(i, j);
  });

  // Grids of grids, up to one.
  while (tree_.back().size().cells() > 1) {
    const auto& below = tree_.back();
    Raster<Bounds> above({parts(below.cols()), parts(below.rows())});
    for (int j = 0; j < below.rows(); ++j)
      for (int i = 0; i < below.cols(); ++i) {
        Bounds& bounds = above(i >> kShift, j >> kShift);
        bounds.low = std::min(bounds.low, below(i, j).low);
        bounds.high = std::max(bounds.high, below(i, j).high);
      }
    tree_.push_back(std::move(above));
  }
  low_ = tree_.back()(0, 0).low;
  high_ = tree_.back()(0, 0).high;
}

bool Heightfield::trace(const Ray& ray, Walk& w) const {
  const auto [o, d, t_max] = ray;
  if (!std::isfinite(o.x + o.y + o.z + d.x + d.y + d.z)) return false;
  w.x = o.x / spacing_.dx_m, w.y = -o.y / spacing_.dy_m, w.z = o.z;
  w.dx = d.x / spacing_.dx_m, w.dy = -d.y / spacing_.dy_m, w.dz = d.z;
  w.from = 0, w.to = t_max;

  // The part of the ray over the squares and between the lowest and the highest ground, with a
  // margin for rounding. Who comes in through the lid is above ground.
  const int cols = z_.cols() - 1, rows = z_.rows() - 1;
  if (!clip(w.x, w.dx, 0, cols, w.from, w.to) || !clip(w.y, w.dy, 0, rows, w.from, w.to))
    return false;
  const double before = w.from;
  const double margin = 1e-9 * (1 + std::abs(low_) + std::abs(high_) + std::abs(w.z));
  if (!clip(w.z, w.dz, low_ - margin, high_ + margin, w.from, w.to)) return false;
  if (w.from > before) w.side = w.dz < 0 ? 1 : -1;
  if (!(w.to < kInfinity)) return false;  // it goes nowhere

  // The walk: at level 0 squares, at level k grids of tree_[k - 1]; (i, j) of that level.
  const double per_dx = w.dx == 0 ? 0 : 1 / w.dx, per_dy = w.dy == 0 ? 0 : 1 / w.dy;
  const double never_x = w.dx == 0 ? kInfinity : 0, never_y = w.dy == 0 ? kInfinity : 0;
  const int step_x = w.dx < 0 ? -1 : 1, step_y = w.dy < 0 ? -1 : 1;
  const int next_x = w.dx > 0, next_y = w.dy > 0;
  const int top = int(tree_.size());
  int level = top, i = 0, j = 0;
  double t = w.from;
  while (true) {
    // Leaves the part through the side that comes first.
    const int shift = kShift * level;
    const double tx = (std::min((i + next_x) << shift, cols) - w.x) * per_dx + never_x;
    const double ty = (std::min((j + next_y) << shift, rows) - w.y) * per_dy + never_y;
    const double out = std::max(t, std::min({tx, ty, w.to}));

    const double z0 = w.z_at(t), z1 = w.z_at(out);
    if (level == 0) {
      const auto north = z_.row(j), south = z_.row(j + 1);
      const auto c = std::size_t(i);
      const double nw = north[c], ne = north[c + 1], sw = south[c], se = south[c + 1];
      const double lowest = std::min(z0, z1);
      if (lowest > nw && lowest > ne && lowest > sw && lowest > se)
        w.side = 1;
      else if (w.meets(Square(nw, ne, sw, se), i, j, t, out))
        return true;
    } else {
      const Bounds& bounds = tree_[std::size_t(level) - 1](i, j);
      const bool above = std::min(z0, z1) > double(bounds.high);
      const bool below = std::max(z0, z1) < double(bounds.low);
      if (!above && !below) {
        // Down into the part of this grid that the ray is in.
        --level;
        const auto part = [&](double at, int grid, int end) {
          const int first = grid << kShift;
          const int last = std::min(first + kPartsMinus1, (end - 1) >> (kShift * level));
          return std::clamp(int(at) >> (kShift * level), first, last);
        };
        i = part(w.x_at(t), i, cols);
        j = part(w.y_at(t), j, rows);
        continue;
      }
      w.side = has_holes_ ? 0 : above ? 1 : -1;
    }

    // On to the next part, and up when it belongs to another grid.
    if (out >= w.to) return false;
    t = out;
    int& k = tx <= ty ? i : j;
    const int from = k;
    k += tx <= ty ? step_x : step_y;
    if (k < 0 || (tx <= ty ? k << shift >= cols : k << shift >= rows)) return false;
    if (from >> kShift != k >> kShift && level < top) {
      ++level;
      i >>= kShift, j >>= kShift;
    }
  }
}

std::optional<Hit> Heightfield::intersect(const Ray& ray) const {
  Walk walk{};
  if (!trace(ray, walk)) return {};
  Vec3 normal{-walk.east / spacing_.dx_m, walk.south / spacing_.dy_m, 1};
  return Hit{walk.t, walk.col, walk.row, (1 / std::sqrt(dot(normal, normal))) * normal};
}

bool Heightfield::blocks(const Ray& ray) const {
  Walk walk{};
  return trace(ray, walk);
}

std::optional<double> Heightfield::height(double x, double y) const {
  const double u = x / spacing_.dx_m, v = -y / spacing_.dy_m;
  const int cols = z_.cols() - 1, rows = z_.rows() - 1;
  if (!(u >= 0 && v >= 0 && u <= cols && v <= rows)) return {};
  const int c = std::min(int(u), cols - 1), r = std::min(int(v), rows - 1);
  const Square s(z_(c, r), z_(c + 1, r), z_(c, r + 1), z_(c + 1, r + 1));
  const double in_u = s.mirrored ? 1 - (u - c) : u - c, in_v = v - r;
  const double z = s.height(in_u > in_v, in_u, in_v);
  return std::isnan(z) ? std::nullopt : std::optional(z);
}

}  // namespace dem
