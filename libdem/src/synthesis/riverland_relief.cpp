// What RiverLand lays over the valleys [teoh2009, sections 6 and 7]: user ridges, a fractal, rocks.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "dem/mcmd.h"
#include "synthesis/flood.h"
#include "synthesis/riverland_parts.h"

namespace dem::synthesis {
using namespace numeric;
namespace {

constexpr std::uint64_t stream_overlay = 0x4e1a0004, stream_ridges = 0x4e1a0005,
                        stream_rocks = 0x4e1a0006;

/// A cell of a ridge line.
struct Crest {
  Cell cell;
  double height_m, width_m;
};

/// A value between two control points, by random midpoint offset.
struct Offsets {
  std::vector<double> at;
  double operator()(double t) const {
    const double x = t * double(at.size() - 1);
    const auto i = std::min(std::size_t(x), at.size() - 2);
    return std::lerp(at[i], at[i + 1], x - double(i));
  }
};

Offsets offsets(double from, double to, double distance_m, double roughness, std::uint64_t seed,
                std::uint64_t stream) {
  constexpr int levels = 7;
  // The midpoint of a part of length l moves by roughness * l / 2 * gaussian.
  Offsets o{brownian_path(levels, to - from, roughness * distance_m / 8, 1, seed, stream)};
  for (double& v : o.at) v = std::max(0.0, v + from);
  return o;
}

/// The lines of the user's ridges, scan-converted, with heights and widths.
std::vector<Crest> scan_convert(const Country& country, const RiverLandOptions& o) {
  std::vector<Crest> crests;
  std::uint64_t stream = stream_ridges;
  for (std::size_t n = 0; n < country.painted.ridges.size(); ++n) {
    const auto& points = country.painted.ridges[n];
    bool on_land = false;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const RidgePoint &a = points[i], &b = points[i + 1];
      const Cell from{int(std::lround(a.col)), int(std::lround(a.row))},
          to{int(std::lround(b.col)), int(std::lround(b.row))};
      const double distance = country.distance_m(from, to);
      const Offsets height =
          offsets(a.height_m, b.height_m, distance, o.ridge_roughness, o.seed, ++stream);
      const Offsets width =
          offsets(a.width_m, b.width_m, distance, o.ridge_roughness, o.seed, ++stream);
      const auto visit = [&](Cell c) {
        if (country.contains(c) && country.is_land(c)) {
          const double t = distance > 0 ? country.distance_m(from, c) / distance : 0;
          crests.push_back({c, height(t), width(t)});
          on_land = true;
        }
        return true;
      };
      visit(from);
      walk_line(from, to, visit);
    }
    if (!on_land)
      throw std::invalid_argument(
          fmt::format("ridge {} has no cell on the land; must lie inside", n + 1));
  }
  return crests;
}

void check_ridges(const Country& country) {
  for (std::size_t n = 0; n < country.painted.ridges.size(); ++n) {
    const auto& points = country.painted.ridges[n];
    if (points.size() < 2)
      throw std::invalid_argument(
          fmt::format("ridge {} has {} points; must have at least 2", n + 1, points.size()));
    for (const RidgePoint& p : points)
      if (!(std::abs(p.col) < 1e6 && std::abs(p.row) < 1e6 && p.height_m >= 0 &&
            p.height_m <= 10000 && p.width_m > 0 && p.width_m <= 1e6))
        throw std::invalid_argument(fmt::format(
            "ridge {} has a point at ({}, {}), {} m high, {} m wide; must be 0 to 10000 m high and "
            "wider than 0",
            n + 1, p.col, p.row, p.height_m, p.width_m));
  }
}

}  // namespace

UserRidges::UserRidges(const Country& country, const RiverLandOptions& o) {
  if (country.painted.ridges.empty()) return;
  check_ridges(country);
  const std::vector<Crest> crests = scan_convert(country, o);
  z = Raster<float>(country.size());
  line = Mask(country.size());

  // Down from the crests, highest first: linear to 0 where the ridge ends.
  const auto highest = std::ranges::max(crests, {}, &Crest::height_m).height_m;
  CellQueue queue(float(-highest), 0, 4096);
  Raster<float> fall(country.size());  // metres of height per metre of way
  for (const Crest& crest : crests) {
    line(crest.cell.col, crest.cell.row) = 1;
    float& here = z(crest.cell.col, crest.cell.row);
    if (float(crest.height_m) <= here || crest.width_m <= 0) continue;
    here = float(crest.height_m);
    fall(crest.cell.col, crest.cell.row) = float(crest.height_m / crest.width_m);
    queue.push(-here, crest.cell.row * z.cols() + crest.cell.col);
  }
  while (!queue.empty()) {
    const auto [key, index] = queue.pop();
    const int col = index % z.cols(), row = index / z.cols();
    if (-key < z(col, row)) continue;  // raised since
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc) {
        const Cell c{col + dc, row + dr};
        if (!country.contains(c) || !country.is_land(c)) continue;
        const float h = -key - fall(col, row) * float(country.step_m(dc, dr));
        if (h <= z(c.col, c.row)) continue;
        z(c.col, c.row) = h;
        fall(c.col, c.row) = fall(col, row);
        queue.push(-h, c.row * z.cols() + c.col);
      }
  }
}

Raster<float> fractal_overlay(Size size, int nodes, double H, std::uint64_t seed, const Run& run) {
  Dem coarse{Raster<float>(size), Mask(size), {}, {}};
  const double step = std::max(1.0, double(std::max(size.cols, size.rows) - 1) / (nodes - 1));
  const auto known = [&](int n, double s) { return int(std::lround(n * s)); };
  for (int j = 0; known(j, step) < size.rows; ++j)
    for (int i = 0; known(i, step) < size.cols; ++i) {
      coarse.z(known(i, step), known(j, step)) =
          float(signed_uniform(random_bits(seed, stream_overlay, i, j)));
      coarse.known(known(i, step), known(j, step)) = 1;
    }
  // In fill_mcmd noise times distance falls by 2^-(1 + 2 H) from level to level; here by 2^-H, and
  // it is 0.5 at the first level below the nodes.
  McmdOptions o{.H = (H - 1) / 2, .seed = seed};
  const double levels = std::log2(std::max(size.cols, size.rows) / step);
  o.rs = 1 / step * std::exp2(2 * o.H * levels);
  return fill_mcmd(coarse, o, run);
}

Raster<float> rocky_outcrops(const Country& country, const Raster<float>& overlay,
                             const RiverLandOptions& o) {
  const Mask& patch = country.painted.rocks;
  Raster<float> rocks(country.size());
  const double dx = country.cell.dx_m, dy = country.cell.dy_m;
  const int down = int(country.size().rows * dy / o.rock_distance_m) + 1,
            across = int(country.size().cols * dx / o.rock_distance_m) + 1;
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      Sequence random(o.seed, random_bits(stream_rocks, 0, i, j));
      const Point centre{(i + uniform(random)) * o.rock_distance_m,
                         (j + uniform(random)) * o.rock_distance_m};
      const Cell middle = country.cell_at(centre);
      if (!country.contains(middle) || !patch(middle.col, middle.row)) continue;
      const double radius = o.rock_radius_m * (0.6 + 0.8 * uniform(random));
      const double height = o.rock_height_m * (0.5 + uniform(random));
      const int reach_x = int(1.5 * radius / dx) + 1, reach_y = int(1.5 * radius / dy) + 1;
      for (int r = middle.row - reach_y; r <= middle.row + reach_y; ++r)
        for (int c = middle.col - reach_x; c <= middle.col + reach_x; ++c) {
          if (!country.contains({c, r}) || !patch(c, r)) continue;
          // A ragged foot: the overlay stretches the distance.
          const double d = length(country.centre_of({c, r}) - centre) / radius *
                           (1 + 0.4 * std::clamp(double(overlay(c, r)), -1.0, 1.0));
          if (d >= 1) continue;
          rocks(c, r) =
              std::max(rocks(c, r), float(height * (1 - std::pow(d, 2 * o.rock_steepness))));
        }
    }
  return rocks;
}

}  // namespace dem::synthesis
