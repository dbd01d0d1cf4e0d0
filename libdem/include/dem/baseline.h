#pragma once
// The simplest filler, to be compared with.

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

struct NearestOptions {};
std::vector<Field> fields(NearestOptions& options);

/// Gives every unknown cell the elevation of the nearest known cell, in metres (dem.spacing), exact
/// Euclidean; of equally near ones the smaller elevation wins, so mirrored input gives mirrored
/// output. Method:   lower envelope of parabolas, one pass over columns and one over rows
/// [felzenszwalb2012]. Cost:     O(cells); 12 bytes a cell. Throws:   std::invalid_argument when no
/// cell is known, Cancelled.
Raster<float> fill_nearest(const Dem& dem, const NearestOptions& options = {}, const Run& run = {});

}  // namespace dem
