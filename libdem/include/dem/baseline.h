#pragma once
// The simplest filler, to be compared with.

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// It has none.
struct NearestOptions {};
std::vector<Field> fields(NearestOptions& options);

/// Gives every unknown cell the elevation of the nearest known cell, in metres (dem.spacing), exact
/// Euclidean; of equally near ones the smaller elevation wins: mirrored input, mirrored output.
/// Method:   lower envelope of parabolas, along columns, then rows [felzenszwalb2012]. Squared
///           distances are whole numbers (times a power of two), so that ties are exact.
/// Cost:     O(cells); 8 bytes a cell, the result among them.
/// Throws:   std::invalid_argument when no cell is known or the spacing is not > 0, Cancelled.
Raster<float> fill_nearest(const Dem& dem, const NearestOptions& options = {}, const Run& run = {});

}  // namespace dem
