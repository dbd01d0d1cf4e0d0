#pragma once
// Maps of surfaces, as rasters of bytes. dem/raytrace.h has perspective views.

#include <cstdint>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/palette.h"
#include "dem/run.h"

namespace dem {

/// The light on a map.
struct HillshadeOptions {
  double azimuth_deg = 315;  ///< where the light comes from, clockwise from north
  double altitude_deg = 45;
  double exaggeration = 1;        ///< heights are multiplied by it first
  bool multidirectional = false;  ///< from four sides
};
std::vector<Field> fields(HillshadeOptions& options);

/// Hillshade in grey, 0 dark to 255 lit; cells where `known` is 0 (when given) are drawn white.
/// Method: Lambert shading; slopes by Horn's 3 x 3 differences [horn1981], one-sided at the rim.
///         Multidirectional: lights 90 and 45 degrees to the left of the azimuth, at it, and 45
///         degrees to its right, each weighted by the squared sine of the angle between it and the
///         way the ground falls [mark1992]: light across the slopes, which keeps detail where one
///         light leaves black or white.
/// Throws: std::invalid_argument.
Raster<std::uint8_t> hillshade(const Raster<float>& z, Spacing spacing,
                               const HillshadeOptions& options = {}, const Mask& known = {},
                               const Run& run = {});

struct ReliefOptions {
  HillshadeOptions light = {};
  Palette palette = Palette::atlas;
  bool sea = false;  ///< heights at or below 0 are water
};
std::vector<Field> fields(ReliefOptions& options);

/// Colours by height, from the lowest to the highest known cell, under a hillshade; cells where
/// `known` is 0 (when given) are drawn white. Level ground has exactly the palette's colour; ground
/// turned to the light is paler, ground turned away darker and bluer, as the sky lights it.
/// Throws: std::invalid_argument.
Raster<Rgb> shaded_relief(const Raster<float>& z, Spacing spacing,
                          const ReliefOptions& options = {}, const Mask& known = {},
                          const Run& run = {});

}  // namespace dem
