#pragma once
// A river as the generators draw it.

#include <vector>

#include "dem/raster.h"

namespace dem {

/// A river, from its source to its mouth; each cell is a neighbour of the one before.
struct River {
  std::vector<Cell> path;  ///< the last cell is at the sea or the map's edge, or on another river
  int joins = -1;          ///< the number of the river that it joins; -1: none
  double mass = 1;         ///< how many sources feed it
};

}  // namespace dem
