#pragma once
// The holes of a raster that is looked at part by part, in any order and on any machine.

#include <cstddef>
#include <vector>

#include "dem/holes.h"

namespace dem {

/// A known cell beside a hole.
struct RimCell {
  int row = 0, col = 0;
  float z = 0;
};

/// What one part of a raster tells of its holes; places are in cells of the raster.
struct HolePart {
  std::vector<Hole> holes;    ///< those that lie in this part alone: they are complete
  std::vector<CellRun> runs;  ///< this part's cells of all others, row by row
  std::vector<RimCell> rim;   ///< known cells beside those runs
  std::size_t known_cells = 0;
};

/// Looks at one part of a raster. Parts are boxes that cover the raster and do not overlap.
/// `dem`: the cells of with_ring(part, raster), so that what touches the part from outside is seen.
/// `spacing`: of each row of the raster.
HolePart scan_part(const Dem& dem, const Box& part, Size raster,
                   const std::vector<Spacing>& spacing);

/// A box with the ring of cells around it, as far as the raster goes.
Box with_ring(const Box& box, Size raster);

/// The holes of the raster, from all its parts.
/// Gives: exactly what find_holes gives for the raster as a whole, in the same order.
/// Cost:  O(cells of the boxes of the holes that reach several parts).
std::vector<Hole> join_parts(const std::vector<HolePart>& parts, Size raster,
                             const std::vector<Spacing>& spacing);

}  // namespace dem
