#pragma once
// The simplest fill method, for comparison.

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// The method has no options.
struct NearestOptions {};
std::vector<Field> fields(NearestOptions& options);

/// Gives every unknown cell the elevation of the nearest known cell.
/// Distances are exact Euclidean distances in metres (dem.spacing). Of equally near cells the one
/// with the smaller elevation counts, so mirrored input gives mirrored output.
/// Method: lower envelope of parabolas, along columns, then along rows [felzenszwalb2012]. Squared
///         distances are whole numbers (times a power of two), so ties are exact.
/// Cost:   O(cells); 8 bytes a cell, including the result.
/// Throws: std::invalid_argument when no cell is known or the spacing is not > 0; Cancelled.
Raster<float> fill_nearest(const Dem& dem, const NearestOptions& options = {}, const Run& run = {});

}  // namespace dem
