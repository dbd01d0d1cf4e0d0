#pragma once
// Pictures of surfaces, as rasters of bytes.

#include <array>
#include <cstdint>

#include "dem/dem.h"

namespace dem {

using Rgb = std::array<std::uint8_t, 3>;

/// Lambert shading of the surface lit from azimuth_deg (clockwise from north) at altitude_deg.
struct HillshadeOptions {
  double azimuth_deg = 315;
  double altitude_deg = 45;
  double exaggeration = 1;  ///< heights are multiplied by it first
};

/// Hillshade in grey, 0 dark to 255 lit; slopes by Horn's 3 x 3 differences, one-sided at the rim.
Raster<std::uint8_t> hillshade(const Raster<float>& z, Spacing spacing,
                               const HillshadeOptions& options = {});

/// Colour relief under a hillshade; cells where `known` is 0 (when given) are drawn white.
Raster<Rgb> shaded_relief(const Raster<float>& z, Spacing spacing,
                          const HillshadeOptions& options = {}, const Mask& known = {});

}  // namespace dem
