#pragma once
// Contour cells with two sides: what lies uphill of a line rises, what lies downhill falls.
// Private to the library.

#include "dem/dem.h"
#include "dem/run.h"

namespace dem::midpoint {

/// The DEM with the unknown cells beside its contour lines known.
/// Method: [belhadj2007] section 5: "two behaviors are necessary in order to interpolate upper
///         neighbors (one side of the contour line) and lower ones". A contour cell looks for the
///         nearest known cell above it and the nearest below it, at most 48 cells away; these give
///         the slopes of its two sides and the way uphill. Where one is missing, beyond the last
///         line, the other side's slope goes on, for half its step at most. Each unknown neighbour
///         takes the mean of what the contour cells around say of it, weighted by 1 / distance^2.
Dem with_contour_sides(const Dem& dem, const Run& run);

}  // namespace dem::midpoint
