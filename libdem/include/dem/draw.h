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
  double exaggeration = 1;        ///< factor for the heights
  bool multidirectional = false;  ///< light from four sides
};
std::vector<Field> fields(HillshadeOptions& options);

/// Hillshade in grey, from 0 (dark) to 255 (lit). Cells where `known` is 0 (if given) are white.
/// Method: Lambert shading. Slopes are Horn's 3 x 3 differences [horn1981], one-sided at the
///         border. Multidirectional: the lights stand 90 and 45 degrees to the left of the azimuth,
///         at it, and 45 degrees to its right. Each is weighted by the squared sine of the angle
///         between it and the direction of steepest descent [mark1992]. Light then comes across the
///         slopes, and keeps detail where one light leaves black or white.
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

/// Colours by height, from the lowest to the highest known cell, under a hillshade. Cells where
/// `known` is 0 (if given) are white.
/// Level ground has exactly the colour of the palette. Ground that faces the light is paler. Ground
/// that faces away from it is darker and bluer, because the sky lights it.
/// Throws: std::invalid_argument.
Raster<Rgb> shaded_relief(const Raster<float>& z, Spacing spacing,
                          const ReliefOptions& options = {}, const Mask& known = {},
                          const Run& run = {});

}  // namespace dem
