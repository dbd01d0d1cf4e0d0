#pragma once
// Lattices for points: over given bounds, or from the density of the points.

#include <string>

#include "dem/points.h"

namespace dem {

enum class CellUnit { metres, degrees };

/// The size of a cell: "30" or "30m", "1s" (arc second), "0.5min", "0.001deg".
struct CellSize {
  double value = 0;
  CellUnit unit = CellUnit::metres;
};

/// Throws std::invalid_argument when the text has no number above 0 or another unit.
CellSize parse_cell_size(const std::string& text);

/// A rectangle in the units of a coordinate system.
struct Bounds {
  double west = 0, south = 0, east = 0, north = 0;
};

/// "W,S,E,N". Throws std::invalid_argument.
Bounds parse_bounds(const std::string& text);

/// The lattice of square cells over `bounds`, which are the outer edges of its cells (with `nodes`:
/// the centres of the outer cells).
/// If their distance is not a whole number of cells, east and south change. In degrees, a cell that
/// is given in metres is square in metres at the middle latitude. In metres, a cell in degrees is
/// an error.
/// Throws std::invalid_argument: no area, cells that do not suit the system, more than 2^31 cells.
Lattice lattice_over(const Bounds& bounds, CellSize cell, const std::string& crs_wkt, bool nodes);

/// The lattice that suits points of this density. Its cells have half the mean distance of the
/// points, rounded to 1, 2 or 5 times a power of ten of the unit of the system. Its edges are
/// multiples of the cell size.
/// Throws std::invalid_argument when the points cover no area.
Lattice lattice_for(const Extent& extent, const std::string& crs_wkt);

}  // namespace dem
