#include "grid_json.h"

#include <cmath>

namespace dem::app {

Json as_json(const LatticePoints& points, const Dem& dem) {
  const BinCounts& n = points.binned.counts;
  return {{"format", points.source.format},
          {"notes", points.source.notes},
          {"crs", crs_name(dem.ref.crs_wkt)},
          {"cols", dem.size().cols},
          {"rows", dem.size().rows},
          {"cell", {std::abs(dem.ref.to_world[1]), std::abs(dem.ref.to_world[5])}},
          {"cell_m", {dem.spacing.dx_m, dem.spacing.dy_m}},
          {"lattice_from", points.lattice_from},
          {"points", n.points},
          {"without_z", points.source.without_z},
          {"other_class", points.source.other_class},
          {"outside", n.outside},
          {"parted", n.parted},
          {"combined", n.combined},
          {"duplicates", n.duplicates},
          {"outlier_cells", n.outliers},
          {"known_cells", n.cells}};
}

std::size_t cells_of(const std::vector<ClosedOff>& areas) {
  std::size_t cells = 0;
  for (const ClosedOff& area : areas) cells += area.cells;
  return cells;
}

}  // namespace dem::app
