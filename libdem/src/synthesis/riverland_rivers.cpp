// The river network of RiverLand [teoh2009, section 4].

#include <algorithm>
#include <optional>

#include "synthesis/riverland_parts.h"

namespace dem::synthesis {
using namespace numeric;
namespace {

constexpr std::uint64_t stream_growth = 0x4e1a0001, stream_levels = 0x4e1a0002;
constexpr double curl = 0.35;         // how far a curve's handles reach, in parts of its chord
constexpr double least_bulge = 0.02;  // of a bend that has a concave bank, in parts of its chord
constexpr std::size_t least_cells = 6;

/// Where a river may begin: at the coast, or on the bank of another.
struct Seed {
  Cell cell;
  Point direction;
  int parent;
};

/// What makes one river unlike another.
struct Character {
  double segment_m, turn, meander;
  int segments;
};

class Growth {
 public:
  Growth(const Country& country, const UserRidges& ridges, const RiverLandOptions& o)
      : country_(country),
        ridges_(ridges),
        o_(o),
        random_(o.seed, stream_growth),
        room_(distance_to_coast()),
        owner_(country.size()) {}

  std::vector<GrownRiver> grow(const Run& run) {
    grow_from_coast(run);
    while (!seeds_.empty() && has_more_to_grow(run)) {
      std::swap(seeds_[random_.below(seeds_.size())], seeds_.back());
      const Seed seed = seeds_.back();
      seeds_.pop_back();
      grow_from(seed);
    }
    return std::move(rivers_);
  }

 private:
  /// In metres, up to clearance_m.
  Raster<float> distance_to_coast() const {
    const float most = float(o_.clearance_m);
    Raster<float> d(country_.size());
    for (std::size_t i = 0; i < d.cells().size(); ++i)
      d.cells()[i] = country_.painted.land.cells()[i] && !country_.coast.cells()[i] ? most : 0.0F;
    const auto x = float(country_.cell.dx_m), y = float(country_.cell.dy_m);
    const float xy = float(country_.step_m(1, 1));
    // Down with the four neighbours before, then up with the four after:   xy y xy
    // (inner cells only: the map's edge is coast or sea)                    x  .
    const auto relax = [&](float* at, std::ptrdiff_t cols, int sign) {
      const std::ptrdiff_t s = sign;
      *at = std::min(
          {*at, at[-s] + x, at[-s * cols] + y, at[-s * cols - s] + xy, at[-s * cols + s] + xy});
    };
    for (int row = 1; row + 1 < d.rows(); ++row)
      for (int col = 1; col + 1 < d.cols(); ++col) relax(&d(col, row), d.cols(), 1);
    for (int row = d.rows() - 2; row > 0; --row)
      for (int col = d.cols() - 2; col > 0; --col) relax(&d(col, row), d.cols(), -1);
    return d;
  }

  bool has_more_to_grow(const Run& run) const {
    run.report(double(rivers_.size()) / o_.rivers, "rivers");
    return int(rivers_.size()) < o_.rivers;
  }

  void grow_from_coast(const Run& run) {
    std::vector<Cell> coast, mouths;
    for (int row = 0; row < country_.size().rows; ++row)
      for (int col = 0; col < country_.size().cols; ++col)
        if (country_.coast(col, row)) coast.push_back({col, row});
    const int tries = 50 * o_.mouths;
    for (int n = 0; n < tries && int(mouths.size()) < o_.mouths && has_more_to_grow(run); ++n) {
      const Cell c = coast[random_.below(coast.size())];
      const bool crowded = std::ranges::any_of(
          mouths, [&](Cell other) { return country_.distance_m(c, other) < o_.mouth_distance_m; });
      if (!crowded && grow_from({c, inland(c), -1})) mouths.push_back(c);
    }
  }

  /// Away from the sea: toward the mean of the land cells around.
  Point inland(Cell c) {
    constexpr int reach = 5;
    Point sum;
    for (int dr = -reach; dr <= reach; ++dr)
      for (int dc = -reach; dc <= reach; ++dc) {
        const Cell other{c.col + dc, c.row + dr};
        if (country_.contains(other) && country_.is_land(other))
          sum = sum + country_.centre_of(other) - country_.centre_of(c);
      }
    const double l = length(sum);
    return l > 0 ? (1 / l) * sum : random_direction(random_);
  }

  double between(double low, double high) { return low + (high - low) * uniform(random_); }

  /// False when there is no room for a river.
  bool grow_from(const Seed& seed) {
    const Character character{o_.segment_m * between(0.6, 1.4), o_.turn * between(0.5, 1.5),
                              o_.meander * between(0.5, 1.5),
                              std::max(1, int(o_.segments * between(0.4, 1.6)))};
    const std::vector<Point> points = segment_points(seed, character);
    return points.size() > 1 && draw(seed, points, character);
  }

  /// Points of the river, as long as there is room.
  std::vector<Point> segment_points(const Seed& seed, const Character& character) {
    std::vector<Point> points{country_.centre_of(seed.cell)};
    Point direction = seed.direction;
    for (int i = 0; i < character.segments; ++i) {
      if (i > 0) direction = turned(direction, character.turn * signed_uniform(random_.bits()));
      direction = up_the_ridge(points.back(), direction);
      const Point next = points.back() + character.segment_m * between(0.75, 1.25) * direction;
      if (!has_room(points.front(), points.back(), next)) break;
      points.push_back(next);
    }
    return points;
  }

  /// Within a user's ridge a river comes straight down its flank, but for a narrow angle.
  Point up_the_ridge(Point p, Point direction) {
    if (ridges_.none()) return direction;
    const Cell c = country_.cell_at(p);
    constexpr int reach = 3;
    if (!country_.contains({c.col - reach, c.row - reach}) ||
        !country_.contains({c.col + reach, c.row + reach}) || ridges_.z(c.col, c.row) <= 0)
      return direction;
    const Point up{double(ridges_.z(c.col + reach, c.row) - ridges_.z(c.col - reach, c.row)) /
                       country_.cell.dx_m,
                   double(ridges_.z(c.col, c.row + reach) - ridges_.z(c.col, c.row - reach)) /
                       country_.cell.dy_m};
    const double l = length(up);
    if (l == 0) return direction;
    return turned((1 / l) * up, 0.1 * signed_uniform(random_.bits()));
  }

  /// Whether a segment keeps away from coast, other rivers and ridge lines. Near its start, where a
  /// river leaves the coast or another river, it needs less room.
  bool has_room(Point start, Point from, Point to) const {
    const double l = length(to - from), stride = std::min(country_.cell.dx_m, country_.cell.dy_m);
    for (double s = stride; s <= l; s += stride) {
      const Point p = from + (s / l) * (to - from);
      const Cell c = country_.cell_at(p);
      if (!country_.contains(c)) return false;
      if (!ridges_.none() && ridges_.line(c.col, c.row)) return false;
      const double need = std::min(0.9 * o_.clearance_m, 0.4 * length(p - start) - 2 * stride);
      if (double(room_(c.col, c.row)) < need) return false;
    }
    return true;
  }

  /// Fits a meandering curve through the points, and makes a river of the cells that it passes.
  bool draw(const Seed& seed, const std::vector<Point>& points, const Character& character) {
    const int number = int(rivers_.size());
    GrownRiver river{{seed.cell}, seed.parent};
    const bool of_coast = seed.parent < 0;
    if (of_coast && owner_(seed.cell.col, seed.cell.row)) return false;
    if (of_coast) owner_(seed.cell.col, seed.cell.row) = number + 1;

    std::vector<Seed> banks;
    double side = random_.below(2) ? 1 : -1;
    Point leave = tangent(points, 0, seed.direction, side * character.meander);
    bool open = true;
    for (std::size_t k = 1; k < points.size() && open; ++k, side = -side) {
      const Point a = points[k - 1], b = points[k];
      const double chord = length(b - a);
      const Point arrive = tangent(points, k, {}, -side * character.meander * between(0.5, 1.5));
      const Point handle_a = a + curl * chord * leave, handle_b = b - curl * chord * arrive;
      const int samples =
          std::max(4, int(2 * chord / std::min(country_.cell.dx_m, country_.cell.dy_m)));
      Cell middle = river.path.back();
      for (int i = 1; i <= samples && open; ++i) {
        open = extend(river, number, bezier(a, handle_a, handle_b, b, double(i) / samples));
        if (i == samples / 2) middle = river.path.back();
      }
      // The concave bank is on the outer side of the bend.
      const Point bulge = bezier(a, handle_a, handle_b, b, 0.5) - 0.5 * (a + b);
      if (open && length(bulge) > least_bulge * chord) {
        const Point out = (1 / length(bulge)) * bulge + (0.5 / chord) * (b - a);
        banks.push_back({middle, (1 / length(out)) * out, number});
      }
      leave = arrive;
    }

    if (river.path.size() < least_cells) {
      for (std::size_t i = of_coast ? 0 : 1; i < river.path.size(); ++i)
        owner_(river.path[i].col, river.path[i].row) = 0;
      return false;
    }
    take_room(river);
    seeds_.insert(seeds_.end(), banks.begin(), banks.end());
    rivers_.push_back(std::move(river));
    return true;
  }

  /// The direction of the curve at a point: that of its neighbours, turned.
  static Point tangent(const std::vector<Point>& points, std::size_t k, Point at_start,
                       double half_tangent) {
    Point along = at_start;
    if (k > 0) along = points[std::min(k + 1, points.size() - 1)] - points[k - 1];
    return turned((1 / length(along)) * along, half_tangent);
  }

  static Point bezier(Point a, Point b, Point c, Point d, double t) {
    const double u = 1 - t;
    return u * u * u * a + 3 * u * u * t * b + 3 * u * t * t * c + t * t * t * d;
  }

  /// Leads a river on to a point; false when something is in its way.
  bool extend(GrownRiver& river, int number, Point to) {
    bool open = true;
    walk_line(river.path.back(), country_.cell_at(to), [&](Cell c) {
      const Cell from = river.path.back();
      open = country_.contains(c) && country_.is_land(c) && !country_.coast(c.col, c.row) &&
             !owner_(c.col, c.row) &&
             !(owner_(c.col, from.row) && owner_(from.col, c.row)) &&  // between two diagonal cells
             (ridges_.none() || !ridges_.line(c.col, c.row));
      if (!open) return false;
      owner_(c.col, c.row) = number + 1;
      river.path.push_back(c);
      return true;
    });
    return open;
  }

  /// Marks the room around a river as taken.
  void take_room(const GrownRiver& river) {
    const int across = int(o_.clearance_m / country_.cell.dx_m),
              down = int(o_.clearance_m / country_.cell.dy_m);
    for (std::size_t i = 0; i < river.path.size(); i += 2) {
      const Cell c = river.path[i];
      for (int r = std::max(0, c.row - down); r <= std::min(room_.rows() - 1, c.row + down); ++r) {
        const double y = (r - c.row) * country_.cell.dy_m;
        for (int col = std::max(0, c.col - across);
             col <= std::min(room_.cols() - 1, c.col + across); ++col) {
          const double x = (col - c.col) * country_.cell.dx_m;
          float& room = room_(col, r);
          if (x * x + y * y < double(room) * double(room)) room = float(std::sqrt(x * x + y * y));
        }
      }
    }
  }

  const Country& country_;
  const UserRidges& ridges_;
  const RiverLandOptions& o_;
  Sequence random_;
  Raster<float> room_;  // metres to the nearest river or coast, up to clearance_m
  Raster<std::int32_t> owner_;
  std::vector<Seed> seeds_;  // on banks
  std::vector<GrownRiver> rivers_;
};

}  // namespace

std::vector<GrownRiver> grow_meanders(const Country& country, const UserRidges& ridges,
                                      const RiverLandOptions& o, const Run& run) {
  return Growth(country, ridges, o).grow(run);
}

Water fill_rivers(const Country& country, const UserRidges& ridges,
                  std::span<const GrownRiver> rivers, const RiverLandOptions& o) {
  constexpr double in_ridge = 0.7;  // a river in a user's ridge cuts no deeper
  Water water{Raster<float>(country.size(), far_away), Mask(country.size())};
  Sequence random(o.seed, stream_levels);

  // Up each river from its mouth, parents before their tributaries.
  for (const auto& river : rivers) {
    const double slope = o.river_slope * (0.5 + uniform(random));
    double to_source = 0;
    for (std::size_t i = 1; i < river.path.size(); ++i)
      to_source += country.distance_m(river.path[i - 1], river.path[i]);
    const Cell mouth = river.path.front();
    double level = river.parent < 0 ? 0 : double(water.level(mouth.col, mouth.row));
    water.level(mouth.col, mouth.row) = float(level);
    for (std::size_t i = 1; i < river.path.size(); ++i) {
      const double step = country.distance_m(river.path[i - 1], river.path[i]);
      to_source -= step;
      const double head = std::max(0.0, 1 - to_source / o.head_m);
      level += slope * step * (0.5 + uniform(random)) * (1 + (o.head_steepness - 1) * head);
      if (!ridges.none())
        level = std::max(level, in_ridge * double(ridges.z(river.path[i].col, river.path[i].row)));
      water.level(river.path[i].col, river.path[i].row) = float(level);
    }
  }

  // Down again: kilometres of river above each cell make its width.
  Raster<float> above(country.size());
  for (std::size_t n = rivers.size(); n-- > 0;) {
    const auto& path = rivers[n].path;
    float flow = 0;
    for (std::size_t i = path.size(); i-- > 0;) {
      float& here = above(path[i].col, path[i].row);
      const bool joint = i == 0 && rivers[n].parent >= 0;
      if (i + 1 < path.size()) flow += float(country.distance_m(path[i], path[i + 1]) / 1000);
      if (!joint) flow += here;  // what tributaries brought
      here = joint ? here + flow : flow;
    }
  }
  constexpr std::uint8_t on_path = 1, bank = 2;
  for (const auto& river : rivers)
    for (Cell c : river.path) water.wet(c.col, c.row) = on_path;
  for (const auto& river : rivers)
    for (Cell c : river.path) {
      const double radius = o.river_width_m * std::sqrt(double(above(c.col, c.row))) / 2;
      const int across = int(radius / country.cell.dx_m), down = int(radius / country.cell.dy_m);
      for (int dr = -down; dr <= down; ++dr)
        for (int dc = -across; dc <= across; ++dc) {
          const Cell b{c.col + dc, c.row + dr};
          if (country.step_m(dc, dr) > radius || !country.contains(b)) continue;
          if (!country.is_land(b) || country.coast(b.col, b.row)) continue;
          std::uint8_t& wet = water.wet(b.col, b.row);
          if (wet == on_path) continue;
          wet = bank;
          water.level(b.col, b.row) =
              std::min(water.level(b.col, b.row), water.level(c.col, c.row));
        }
    }
  return water;
}

}  // namespace dem::synthesis
