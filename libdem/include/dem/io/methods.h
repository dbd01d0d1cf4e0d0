#pragma once
// Fillers of other libraries, in the same table form, to be compared with.

#include <vector>

#include "dem/methods.h"

namespace dem {

/// `idw`: GDALFillNodata, inverse distance along eight (GDAL: four conic) directions, no distance
/// limit, `smoothing_passes` 0 by default. `pushpull`: OpenImageIO's fillholes_pushpull.
const std::vector<FillMethod>& baseline_methods();

/// fill_methods() and baseline_methods().
const std::vector<FillMethod>& all_fill_methods();

}  // namespace dem
