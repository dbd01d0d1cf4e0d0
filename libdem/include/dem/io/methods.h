#pragma once
// Fill methods of other libraries, in the same table form, for comparison.

#include <vector>

#include "dem/methods.h"

namespace dem {

/// `idw` is GDALFillNodata: inverse distance in eight directions (four conic ones in GDAL), without
/// a distance limit, with `smoothing_passes` 0 by default. `pushpull` is OpenImageIO's
/// fillholes_pushpull.
const std::vector<FillMethod>& baseline_methods();

/// fill_methods() and baseline_methods().
const std::vector<FillMethod>& all_fill_methods();

}  // namespace dem
