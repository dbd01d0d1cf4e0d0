#pragma once
// The steps of make_riverland. Private to it.

#include <limits>
#include <span>
#include <vector>

#include "dem/riverland.h"
#include "synthesis/paths.h"

namespace dem::synthesis {

/// What the steps share: the painted land, its coast and the size of a cell.
struct Country {
  const Land& painted;
  Spacing cell;
  Mask coast;  ///< land cells beside the sea or on the map's edge: at height 0

  Country(const Land& land, Spacing spacing);

  Size size() const { return coast.size(); }
  bool contains(Cell c) const { return coast.contains(c.col, c.row); }
  bool is_land(Cell c) const { return painted.land(c.col, c.row) != 0; }
  Point centre_of(Cell c) const { return {c.col * cell.dx_m, c.row * cell.dy_m}; }
  Cell cell_at(Point p) const {
    return {int(std::floor(p.x / cell.dx_m + 0.5)), int(std::floor(p.y / cell.dy_m + 0.5))};
  }
  double distance_m(Cell a, Cell b) const { return length(centre_of(a) - centre_of(b)); }
  double step_m(int dc, int dr) const { return length({dc * cell.dx_m, dr * cell.dy_m}); }
};

constexpr float far_away = std::numeric_limits<float>::infinity();

/// The ground that the user's ridges make: heights above 0, and their lines. Empty without ridges.
struct UserRidges {
  Raster<float> z;
  Mask line;

  explicit UserRidges(const Country& country, const RiverLandOptions& options);
  bool none() const { return z.empty(); }
};

/// Rivers from their mouths up; a tributary begins with the cell of its parent that it joins.
struct GrownRiver {
  std::vector<Cell> path;
  int parent = -1;
};

std::vector<GrownRiver> grow_meanders(const Country& country, const UserRidges& ridges,
                                      const RiverLandOptions& options, const Run& run);

/// Levels of river cells (far_away elsewhere); wet: 1 on paths, 2 on the cells that make them wide.
struct Water {
  Raster<float> level;
  Mask wet;
};
Water fill_rivers(const Country& country, const UserRidges& ridges,
                  std::span<const GrownRiver> rivers, const RiverLandOptions& options);

/// Of every land cell: the rise from its river or coast, and along which way.
struct Valleys {
  Raster<float> rise;               ///< slope times distance, in metres
  Raster<float> foot;               ///< the level of the river or coast that the way leads to
  Raster<float> slope;              ///< the slope along the way
  Raster<std::int32_t> toward;      ///< the next cell of the way; itself at its end
  std::vector<std::int32_t> order;  ///< land cells by rising `rise`

  /// Horizontal distance to the river or coast.
  float distance_m(std::size_t i) const { return rise.cells()[i] / slope.cells()[i]; }
};
Valleys find_valleys(const Country& country, const Water& water, const RiverLandOptions& options,
                     const Run& run);

/// Heights by maximal cells, without their cliffs.
Raster<float> raise_land(const Country& country, const Water& water, const Valleys& valleys,
                         const RiverLandOptions& options, const Run& run);

/// (height at distance x) / (height of the linear profile there).
double profile_factor(SlopeProfile profile, double x);

/// A fractal between about -1 and 1 from nodes x nodes random heights.
Raster<float> fractal_overlay(Size size, int nodes, double H, std::uint64_t seed, const Run& run);

/// Heights of rocky outcrops in the painted patches, to be added.
Raster<float> rocky_outcrops(const Country& country, const Raster<float>& overlay,
                             const RiverLandOptions& options);

}  // namespace dem::synthesis
