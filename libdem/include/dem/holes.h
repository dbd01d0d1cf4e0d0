#pragma once
// The voids of a DEM: connected groups of unknown cells (eight neighbours).

#include <cstddef>

#include "dem/raster.h"

namespace dem {

struct VoidSummary {
  std::size_t cells = 0;         ///< unknown cells
  std::size_t voids = 0;         ///< connected groups of them
  std::size_t largest = 0;       ///< cells of the largest void
  std::size_t border_voids = 0;  ///< voids that touch the rim of the raster
  std::size_t border_cells = 0;  ///< their cells
};

/// Counts the voids of a mask.
/// Method: runs of unknown cells, joined from row to row by union-find.
/// Cost:   O(cells); memory for the runs only.
VoidSummary void_summary(const Mask& known);

/// The unknown cells of those voids that do not touch the rim of the raster: 1 there, 0 elsewhere.
Mask inner_voids(const Mask& known);

}  // namespace dem
