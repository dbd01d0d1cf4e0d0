#include "dem/riverland.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "synthesis/flood.h"
#include "synthesis/riverland_parts.h"

namespace dem {
using namespace synthesis;
namespace {

constexpr float drain_step_m = 0.01F;  // what was dammed up falls by that from cell to cell

void check_land(const Land& land, Spacing spacing) {
  check_map(land.land.size(), spacing, 16, "land with rivers");
  if (count(land.land) == 0)
    throw std::invalid_argument("the drawing has no land; must have white or grey cells");
  if (!land.rocks.empty() && land.rocks.size() != land.land.size())
    throw std::invalid_argument(fmt::format("rocks is {} x {}; must be {} x {} as land, or empty",
                                            land.rocks.cols(), land.rocks.rows(), land.land.cols(),
                                            land.land.rows()));
}

/// Rivers from their sources to their mouths.
std::vector<River> downstream(const std::vector<GrownRiver>& grown) {
  std::vector<River> rivers;
  for (const auto& g : grown) rivers.push_back({{g.path.rbegin(), g.path.rend()}, g.parent, 1});
  for (std::size_t i = rivers.size(); i-- > 0;)
    if (rivers[i].joins >= 0) rivers[std::size_t(rivers[i].joins)].mass += rivers[i].mass;
  return rivers;
}

/// Slope profile, user ridges and overlay, each nothing at rivers and growing away from them.
void shape(const Valleys& valleys, const UserRidges& ridges, const Raster<float>& overlay,
           const Raster<float>& rocks, const RiverLandOptions& o, Raster<float>& z) {
  for (std::int32_t index : valleys.order) {
    const auto i = std::size_t(index);
    const float foot = valleys.foot.cells()[i];
    const double d = double(valleys.distance_m(i));
    double h = double(z.cells()[i] - foot) * profile_factor(o.profile, d / o.profile_m);
    const double rough = double(overlay.cells()[i]);
    if (!ridges.none() && ridges.z.cells()[i] > 0) {
      const double fade = std::min(1.0, d / (2 * o.profile_m));
      h = std::max(
          h, fade * (double(ridges.z.cells()[i]) * (1 + o.overlay_relief * rough) - double(foot)));
    }
    h += o.overlay_relief * d * rough;
    if (!rocks.empty()) h += double(rocks.cells()[i]) * std::min(1.0, d / o.rock_radius_m);
    z.cells()[i] = std::max(foot, float(double(foot) + h));
  }
}

}  // namespace

Country::Country(const Land& land, Spacing spacing)
    : painted(land), cell(spacing), coast(land.land.size()) {
  const int cols = coast.cols(), rows = coast.rows();
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      if (!land.land(col, row)) continue;
      bool inner = col > 0 && row > 0 && col < cols - 1 && row < rows - 1;
      for (int r = row - 1; inner && r <= row + 1; ++r)
        for (int c = col - 1; c <= col + 1; ++c) inner &= land.land(c, r) != 0;
      coast(col, row) = !inner;
    }
}

std::vector<Field> fields(RiverLandOptions& o) {
  return {
      {"mouths", o.mouths, {1, 10000}, "", "river mouths at the most"},
      {"mouth_distance_m", o.mouth_distance_m, {0, 1e7}, "m", "between mouths at least"},
      {"rivers", o.rivers, {1, 100000}, "", "rivers and tributaries at the most"},
      {"clearance_m", o.clearance_m, {1, 1e6}, "m", "a river ends so near to another or the coast"},
      {"segment_m", o.segment_m, {1, 1e6}, "m", "mean length of the segments of a river"},
      {"segments", o.segments, {1, 10000}, "", "mean number of segments of a river"},
      {"turn", o.turn, {0, 1}, "", "largest turn between segments: 0 none, 1 a right angle"},
      {"meander", o.meander, {0, 1}, "", "mean curvature of the meanders, in the same measure"},
      {"river_slope", o.river_slope, {1e-6, 10}, "m/m", "average slope of rivers"},
      {"head_m", o.head_m, {1, 1e6}, "m", "so near to its source a river is steeper"},
      {"head_steepness", o.head_steepness, {1, 100}, "", "how many times, at the source"},
      {"river_width_m",
       o.river_width_m,
       {0, 10000},
       "m",
       "width below 1 km of rivers; grows with its root"},
      {"slope", o.slope, {0.001, 100}, "m/m", "mean slope of valley sides"},
      {"slope_variation",
       o.slope_variation,
       {0, 0.9},
       "",
       "how far it changes from bank to bank, which makes ridges asymmetric"},
      {"smoothing", o.smoothing, {0, 1000}, "", "passes over the heights of maximal cells"},
      {"cliff_slope",
       o.cliff_slope,
       {0.001, 1000},
       "m/m",
       "steeper steps between valleys are removed"},
      {"profile",
       o.profile,
       {"linear", "concave", "convex", "trough", "cliffs", "terraces"},
       "how the ground rises from rivers and coasts"},
      {"profile_m", o.profile_m, {1, 1e6}, "m", "the distance at which the profile bends"},
      {"overlay_nodes",
       o.overlay_nodes,
       {2, 4096},
       "",
       "k: nodes of the fractal overlay along the longer side"},
      {"overlay_relief",
       o.overlay_relief,
       {0, 10},
       "m/m",
       "f: roughness per metre of distance to the river"},
      {"overlay_H", o.overlay_H, {0, 1}, "", "of the overlay; near 0: rough, near 1: smooth"},
      {"ridge_roughness",
       o.ridge_roughness,
       {0, 10},
       "m/m",
       "s: random offsets of heights and widths along user ridges"},
      {"rock_radius_m", o.rock_radius_m, {1, 1e5}, "m", "r: mean radius of a rocky outcrop"},
      {"rock_height_m", o.rock_height_m, {0, 10000}, "m", "h: mean height"},
      {"rock_distance_m", o.rock_distance_m, {1, 1e6}, "m", "d: mean distance between outcrops"},
      {"rock_steepness",
       o.rock_steepness,
       {0.5, 50},
       "",
       "s: 0.5 a cone, 1 a dome, more: a pillar"},
      {"seed", o.seed, "of all of it"},
  };
}

RiverLand make_riverland(const Land& land, Spacing spacing, const RiverLandOptions& o,
                         const Run& run) {
  check_options(o);
  check_land(land, spacing);
  const Country country(land, spacing);
  const UserRidges ridges(country, o);
  const std::vector<GrownRiver> grown = grow_meanders(country, ridges, o, run.part(0, 0.15));
  if (grown.empty())
    throw std::invalid_argument(fmt::format(
        "segment_m = {}; must be shorter: the land has no room for a river", o.segment_m));

  const Water water = fill_rivers(country, ridges, grown, o);
  const Valleys valleys = find_valleys(country, water, o, run.part(0.15, 0.4));
  Raster<float> z = raise_land(country, water, valleys, o, run.part(0.4, 0.6));
  const Raster<float> overlay =
      fractal_overlay(country.size(), o.overlay_nodes, o.overlay_H, o.seed, run.part(0.6, 0.7));
  const Raster<float> rocks =
      land.rocks.empty() ? Raster<float>() : rocky_outcrops(country, overlay, o);
  shape(valleys, ridges, overlay, rocks, o, z);

  // All that is not river, coast or sea drains to them.
  Mask settled = water.wet;
  for (std::size_t i = 0; i < settled.cells().size(); ++i)
    settled.cells()[i] |= std::uint8_t(country.coast.cells()[i] | !land.land.cells()[i]);
  fill_depressions(z, std::move(settled), drain_step_m, run.part(0.75, 1));

  Mask wet = water.wet;
  for (auto& w : wet.cells()) w = w != 0;
  return {std::move(z), downstream(grown), std::move(wet)};
}

Land read_land(const Raster<float>& drawing) {
  Land land{Mask(drawing.size()), {}, {}};
  Mask rocks(drawing.size());
  for (std::size_t i = 0; i < drawing.cells().size(); ++i) {
    land.land.cells()[i] = drawing.cells()[i] >= 0.25F;
    rocks.cells()[i] = drawing.cells()[i] >= 0.25F && drawing.cells()[i] < 0.75F;
  }
  if (count(rocks) > 0) land.rocks = std::move(rocks);
  return land;
}

Land make_island(Size size, std::uint64_t seed, const Run& run) {
  check_map(size, {}, 16, "an island");
  const Raster<float> ragged = fractal_overlay(size, 7, 0.8, seed + 0x15, run);
  Land land{Mask(size), {}, {}};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      const double x = (2 * col + 1.0) / size.cols - 1, y = (2 * row + 1.0) / size.rows - 1;
      const double r = x * x + y * y, inside = 0.8 - 0.7 * r - 0.3 * r * r;
      land.land(col, row) = inside + 0.35 * double(ragged(col, row)) > 0;
    }
  return land;
}

std::vector<Field> fields(GrownLandOptions& o) {
  std::vector<Field> list{
      {"land", o.land, {"island", "whole"}, "an island with a ragged coast, or the whole map"}};
  for (auto& field : fields(o.riverland)) list.push_back(std::move(field));
  return list;
}

Raster<float> generate_riverland(const Canvas& canvas, const GrownLandOptions& o, const Run& run) {
  check_map(canvas.size, canvas.spacing, 16, "land with rivers");
  const Land land = o.land == LandShape::island
                        ? make_island(canvas.size, o.riverland.seed, run.part(0, 0.1))
                        : Land{Mask(canvas.size, 1), {}, {}};
  return make_riverland(land, canvas.spacing, o.riverland, run.part(0.1, 1)).z;
}

Raster<float> generate_painted_land(const Canvas& canvas, const Drawing& drawing,
                                    const RiverLandOptions& o, const Run& run) {
  Land land = read_land(drawing.grey);
  land.ridges = drawing.ridges;
  return make_riverland(land, canvas.spacing, o, run).z;
}

}  // namespace dem
