#pragma once
// A river of a generator.

#include <vector>

#include "dem/raster.h"

namespace dem {

/// A river, from its source to its mouth. Each cell is a neighbour of the one before.
struct River {
  std::vector<Cell> path;  ///< the last cell is at the sea, at the map's edge, or on a river
  int joins = -1;          ///< the number of the river that it joins; -1: none
  double mass = 1;         ///< number of sources that feed it
};

}  // namespace dem
