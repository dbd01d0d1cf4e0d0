#pragma once
// Whether a surface leaves the range of the data around it: the sign of springs that are too stiff
// for the gaps they span. Private to the library.

#include "dem/raster.h"
#include "spline/grid.h"

namespace dem::spline {

/// How far the unknown cells of a surface lie outside the range of the known cells near them (about
/// three times as far as the nearest one): root mean square, as a part of the root mean square of
/// these ranges. The truth had 0.00 to 0.14 in all cases tried, on nine terrains; springs that
/// shoot over a wide flat gap gave 0.2 to 0.8.
/// `distance`: to the nearest known cell, in fifths of a cell. Cost: O(cells), 11 bytes a cell.
double overshoot(const Grid<double>& surface, const Mask& known,
                 const Raster<std::uint16_t>& distance);

}  // namespace dem::spline
