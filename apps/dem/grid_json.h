#pragma once
// What was gridded, as JSON: for --json and Python.

#include "common.h"
#include "dem/io/grid_points.h"

namespace dem::app {

/// What was read, and the lattice, which is that of `dem`.
Json as_json(const LatticePoints& points, const Dem& dem);

/// The number of cells in all areas.
std::size_t cells_of(const std::vector<ClosedOff>& areas);

}  // namespace dem::app
