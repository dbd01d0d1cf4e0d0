#pragma once
// The holes of a raster that is scanned part by part, in any order and on any machine.

#include <cstddef>
#include <vector>

#include "dem/holes.h"

namespace dem {

/// A known cell next to a hole.
struct RimCell {
  int row = 0, col = 0;
  float z = 0;
};

/// What one part of a raster says about its holes. Places are in cells of the raster.
struct HolePart {
  std::vector<Hole> holes;    ///< complete holes, which lie in this part alone
  std::vector<CellRun> runs;  ///< cells in this part of all other holes, row by row
  std::vector<RimCell> rim;   ///< known cells next to those runs
  std::size_t known_cells = 0;
};

/// Scans one part of a raster. Parts are boxes that cover the raster and do not overlap.
/// `dem` has the cells of with_ring(part, raster), so that cells next to the part are seen.
/// `spacing` has one entry for each row of the raster.
HolePart scan_part(const Dem& dem, const Box& part, Size raster,
                   const std::vector<Spacing>& spacing);

/// A box with the ring of cells around it, clipped to the raster.
Box with_ring(const Box& box, Size raster);

/// The holes of the raster, from all its parts.
/// Gives: exactly what find_holes gives for the raster as a whole, in the same order.
/// Cost:  O(cells of the boxes of the holes that reach several parts).
std::vector<Hole> join_parts(const std::vector<HolePart>& parts, Size raster,
                             const std::vector<Spacing>& spacing);

}  // namespace dem
