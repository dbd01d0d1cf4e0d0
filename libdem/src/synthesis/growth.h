#pragma once
// The two halves of grow_skeleton. Private to it.

#include <vector>

#include "dem/networks.h"
#include "synthesis/paths.h"

namespace dem::synthesis {

/// The map, and lengths on it as parts of its longer side.
struct Map {
  Size size;
  double dx, dy;  ///< a cell

  Map(Size s, Spacing spacing) : size(s) {
    const double longer = std::max(s.cols * spacing.dx_m, s.rows * spacing.dy_m);
    dx = spacing.dx_m / longer, dy = spacing.dy_m / longer;
  }
  Cell cell_at(Point p) const { return {int(std::floor(p.x / dx)), int(std::floor(p.y / dy))}; }
  Point centre_of(Cell c) const { return {(c.col + 0.5) * dx, (c.row + 0.5) * dy}; }
  bool contains(Cell c) const {
    return c.col >= 0 && c.row >= 0 && c.col < size.cols && c.row < size.rows;
  }
};

/// A cell of a ridge. Its altitude is ridge_height_m * bell(fall).
struct RidgeCell {
  Cell cell;
  double fall;
  Point along;  ///< the direction that the particle moved in
};

std::vector<RidgeCell> grow_ridges(const Map& map, const NetworkOptions& options, const Run& run);

/// The ground that rivers run on: ridges with their Gaussian cross-sections, blended, on a dome;
/// held on up to 257 nodes a side.
class Ground {
 public:
  Ground(const Map& map, const std::vector<RidgeCell>& ridges, const NetworkOptions& options);

  double altitude_m(Point p) const { return altitude_m(p, sample(fall_, p)); }
  double altitude_m(Point p, double fall) const { return height_m_ * (bell(fall) + dome(p)); }
  Point pull(Point p) const;  ///< downhill

 private:
  struct Place {
    int col, row;
    double x, y;
  };
  Place place(Point p) const;
  double sample(const Raster<float>& nodes, Point p) const;
  double dome(Point p) const;

  double height_m_, dome_;
  Point far_;            ///< the corner of the map that is not at (0, 0)
  Raster<float> fall_;   ///< from the nearest ridge
  Raster<float> depth_;  ///< what pulls: fall_, its basins filled to their outlets
};

std::vector<River> grow_rivers(const Map& map, const Ground& ground,
                               const std::vector<RidgeCell>& ridges, const NetworkOptions& options,
                               const Run& run);

}  // namespace dem::synthesis
