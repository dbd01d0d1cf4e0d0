#pragma once
// Whether a surface leaves the range of the data around it: the sign of springs that are too stiff
// for the gaps they span. Private to the library.

#include "dem/raster.h"
#include "grid.h"

namespace dem {

/// How far the unknown cells of a surface lie outside the range of the known cells near them (about
/// three times as far as the nearest one): root mean square, as a part of the root mean square of
/// these ranges. Real terrain has 0.03 to 0.14 over samples of ten kinds of terrain; springs that
/// shoot over a wide flat gap give more.
/// `distance`: to the nearest known cell, in fifths of a cell. Cost: O(cells), 11 bytes a cell.
double overshoot(const Grid<double>& surface, const Mask& known,
                 const Raster<std::uint16_t>& distance);

}  // namespace dem
