// Ridge particles [belhadj2005, section 2.1], and the ground that their cross-sections make.

#include <algorithm>
#include <limits>

#include "numeric/distance.h"
#include "synthesis/flood.h"
#include "synthesis/growth.h"

namespace dem::synthesis {
using namespace numeric;
namespace {

constexpr std::uint64_t stream_ridges = 0x71d6e001;
constexpr double reach = 3;  // a particle's altitude is null after that many standard deviations
constexpr int candidates = 8;
constexpr double node_step = 1.0 / 256;
constexpr std::uint64_t stream_basins = 0x71d6e003;
constexpr double fall_in_basins = 0.02;  // from node to node

/// One of a couple: it walks from its start in its direction, swayed by Brownian motion.
struct RidgeParticle {
  Point start, direction;
  std::vector<double> sway;
  double fall;  ///< of the start
  int couple;
  Cell cell{};
  bool moving = true;

  Point at(int step, double length) const {
    const auto i = std::size_t(step);
    return start + (length * step / double(sway.size() - 1)) * direction +
           sway[i] * left_of(direction);
  }
};

/// A place for a couple: of several random ones, the farthest from the couples there are.
Point free_place(const Map& map, const std::vector<Point>& taken, Sequence& random) {
  Point best;
  double best_distance = -1;
  for (int i = 0; i < candidates; ++i) {
    const Point p{uniform(random) * map.size.cols * map.dx,
                  uniform(random) * map.size.rows * map.dy};
    double nearest = std::numeric_limits<double>::infinity();
    for (const Point& other : taken) nearest = std::min(nearest, length(p - other));
    if (nearest > best_distance) best = p, best_distance = nearest;
  }
  return best;
}

std::vector<RidgeParticle> place_couples(const Map& map, const NetworkOptions& o, double length,
                                         int levels) {
  std::vector<RidgeParticle> particles;
  std::vector<Point> places;
  Sequence random(o.seed, stream_ridges);
  for (int couple = 0; couple < o.ridges; ++couple) {
    const Point start = free_place(map, places, random);
    const Point direction = random_direction(random);
    const double fall = o.ridge_variation * uniform(random);
    places.push_back(start);
    for (int side : {0, 1}) {
      const double end = o.ridge_wander * length * gaussian(random);
      particles.push_back(
          {start, side ? -1.0 * direction : direction,
           brownian_path(levels, end, o.ridge_wander * length, o.ridge_H, o.seed,
                         stream_ridges + 2 * std::uint64_t(couple) + std::uint64_t(side) + 1),
           fall, couple, map.cell_at(start)});
    }
  }
  return particles;
}

/// Means of three in each direction, weights 1 2 1.
void blur(Raster<float>& z) {
  const auto pass = [](float* v, int n, std::size_t stride) {
    float before = v[0];
    for (int i = 0; i < n; ++i) {
      const float here = v[std::size_t(i) * stride];
      const float after = v[std::size_t(std::min(i + 1, n - 1)) * stride];
      v[std::size_t(i) * stride] = 0.25F * before + 0.5F * here + 0.25F * after;
      before = here;
    }
  };
  for (int row = 0; row < z.rows(); ++row) pass(&z(0, row), z.cols(), 1);
  for (int col = 0; col < z.cols(); ++col) pass(&z(col, 0), z.rows(), std::size_t(z.cols()));
}

/// Fills every basin to its outlet, and a little more with the distance from it: unevenly, so that
/// ways through it wind. `depth` grows downward.
void fill_basins(Raster<float>& depth, std::uint64_t seed) {
  const int cols = depth.cols(), rows = depth.rows();
  const auto index = [&](int c, int r) { return std::int32_t(r * cols + c); };
  const auto [least, most] = std::ranges::minmax(depth.cells());
  CellQueue queue(-most, -least, 1024);
  Mask seen(depth.size());
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col)
      if (col == 0 || row == 0 || col == cols - 1 || row == rows - 1) {
        seen(col, row) = 1;
        queue.push(-depth(col, row), index(col, row));
      }
  while (!queue.empty()) {
    const auto [height, from] = queue.pop();
    const int col = from % cols, row = from / cols;
    for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r)
      for (int c = std::max(0, col - 1); c <= std::min(cols - 1, col + 1); ++c) {
        if (seen(c, r)) continue;
        seen(c, r) = 1;
        const double u = 1 + 0.9 * signed_uniform(random_bits(seed, stream_basins, c, r));
        depth(c, r) = std::min(depth(c, r), float(-double(height) - fall_in_basins * u));
        queue.push(-depth(c, r), index(c, r));
      }
  }
}

}  // namespace

std::vector<RidgeCell> grow_ridges(const Map& map, const NetworkOptions& o, const Run& run) {
  const double sigma = o.ridge_length, length = reach * sigma;
  int levels = 2;  // steps of about two cells
  while (levels < 16 && length / (1 << levels) > 2 * std::max(map.dx, map.dy)) ++levels;

  std::vector<RidgeParticle> particles = place_couples(map, o, length, levels);
  Raster<std::uint16_t> owner(map.size);  // the number of the couple + 1
  std::vector<RidgeCell> cells;
  for (const auto& p : particles)
    if (map.contains(p.cell) && !owner(p.cell.col, p.cell.row)) {
      owner(p.cell.col, p.cell.row) = std::uint16_t(p.couple + 1);
      cells.push_back({p.cell, p.fall, p.direction});
    }

  // All move a step in turn, so that no ridge has the way before another.
  for (int step = 1; step <= 1 << levels; ++step) {
    if (step % 64 == 0) run.report(double(step) / (1 << levels), "ridges");
    const double way = reach * step / (1 << levels);
    for (auto& p : particles) {
      if (!p.moving) continue;
      const Point from = p.at(step - 1, length), to = p.at(step, length);
      const auto other = [&](Cell c) {
        return map.contains(c) && owner(c.col, c.row) && owner(c.col, c.row) != p.couple + 1;
      };
      walk_line(p.cell, map.cell_at(to), [&](Cell c) {
        const bool crosses = other({c.col, p.cell.row}) && other({p.cell.col, c.row});
        p.moving = map.contains(c) && !other(c) && !crosses;
        if (p.moving && owner(c.col, c.row) == 0) {
          owner(c.col, c.row) = std::uint16_t(p.couple + 1);
          cells.push_back(
              {c, p.fall + way * way / 2, (1 / synthesis::length(to - from)) * (to - from)});
        }
        p.cell = c;
        return p.moving;
      });
    }
  }
  return cells;
}

Ground::Ground(const Map& map, const std::vector<RidgeCell>& ridges, const NetworkOptions& o)
    : height_m_(o.ridge_height_m),
      dome_(o.dome),
      far_{map.size.cols * map.dx, map.size.rows * map.dy} {
  const auto nodes = [](double extent) {
    return std::max(2, int(std::ceil(extent / node_step)) + 1);
  };
  fall_ = Raster<float>({nodes(far_.x), nodes(far_.y)}, std::numeric_limits<float>::infinity());
  for (const auto& ridge : ridges) {
    const Point p = map.centre_of(ridge.cell);
    float& f = fall_(int(p.x / node_step + 0.5), int(p.y / node_step + 0.5));
    f = std::min(f, float(ridge.fall));
  }
  const double sigma = o.ridge_length * o.ridge_width;
  const double k = node_step * node_step / (2 * sigma * sigma);
  Envelope envelope;
  std::vector<double> line;
  const auto spread = [&](float* values, int n, std::size_t stride) {
    line.resize(std::size_t(n));
    for (std::size_t i = 0; i < line.size(); ++i) line[i] = double(values[i * stride]);
    envelope.apply(line, k);
    for (std::size_t i = 0; i < line.size(); ++i) values[i * stride] = float(line[i]);
  };
  for (int row = 0; row < fall_.rows(); ++row) spread(&fall_(0, row), fall_.cols(), 1);
  for (int col = 0; col < fall_.cols(); ++col)
    spread(&fall_(col, 0), fall_.rows(), std::size_t(fall_.cols()));
  for (int pass = 0; pass < 3; ++pass) blur(fall_);  // where two cross-sections meet is no crack

  depth_ = fall_;
  fill_basins(depth_, o.seed);
  blur(depth_);
}

/// Highest in the middle, 0 along the edges of the map.
double Ground::dome(Point p) const {
  const double x = 2 * p.x / far_.x - 1, y = 2 * p.y / far_.y - 1;
  return dome_ * std::max(0.0, (1 - x * x) * (1 - y * y));
}

Ground::Place Ground::place(Point p) const {
  const double x = std::clamp(p.x / node_step, 0.0, double(fall_.cols() - 1)),
               y = std::clamp(p.y / node_step, 0.0, double(fall_.rows() - 1));
  const int col = std::min(int(x), fall_.cols() - 2), row = std::min(int(y), fall_.rows() - 2);
  return {col, row, x - col, y - row};
}

double Ground::sample(const Raster<float>& nodes, Point p) const {
  const auto [c, r, x, y] = place(p);
  const double above = std::lerp(double(nodes(c, r)), double(nodes(c + 1, r)), x);
  const double below = std::lerp(double(nodes(c, r + 1)), double(nodes(c + 1, r + 1)), x);
  return std::lerp(above, below, y);
}

Point Ground::pull(Point p) const {
  const Place at = place(p);
  const auto d = [&](int dc, int dr) { return double(depth_(at.col + dc, at.row + dr)); };
  return (1 / node_step) * Point{std::lerp(d(1, 0) - d(0, 0), d(1, 1) - d(0, 1), at.y),
                                 std::lerp(d(0, 1) - d(0, 0), d(1, 1) - d(1, 0), at.x)};
}

}  // namespace dem::synthesis
