#pragma once
// Terrain from noise [musgrave1989]: sums of gradient noises of shorter and shorter waves. The
// roughness can change from place to place. Every height is a function of its place alone.

#include <cstdint>
#include <vector>

#include "dem/canvas.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// How an octave is combined with the sum a of the longer waves. N is its noise, and w its weight
/// lacunarity^(-H i).
///   fbm            a + F (N + c_t) c_s w
///   heterogeneous  a + a (N + c_t) c_s w: rough where high, smooth in the valleys
///   hybrid         a + r (N + c_t) c_s w, r the product of the terms before it, at most 1
///   ridged         a + r (c_t - |N|)^2 c_s w, r = gain times the term before it, in [0, 1]
enum class NoiseLaw { fbm, heterogeneous, hybrid, ridged };

/// The factor F of the first waves of the terrain: 1, a ridge from south to north through the
/// middle of the patch, or a valley along its diagonal from south-west to north-east.
enum class NoiseShape { plain, ridge, valley };

/// How roughness changes from the west of the patch (x = 0) to its east (x = 1): not at all, with H
/// linear to H_east, or with H = 1/x - 3/2, from a plane to noise that fills space.
enum class HLaw { constant, linear, filling };

/// Options of generate_noise. c_t, c_s and c_0 are the symbols of the paper.
struct NoiseOptions {
  NoiseLaw law = NoiseLaw::fbm;
  NoiseShape shape = NoiseShape::plain;
  double wavelength_m = 10000;
  int octaves = 10;
  double lacunarity = 2;
  double H = 0.85;
  HLaw H_law = HLaw::constant;
  double H_east = 0;
  double relief_m = 900;
  double c_t = 0;
  double c_s = 1;
  double c_0 = 0;
  double gain = 2;
  double bend = 0;
  double tilt = 0;
  double warp = 0;
  double patch_m = 0;
  double patch_west_m = 0;
  double patch_south_m = 0;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(NoiseOptions& options);

/// Gradient noise N(x, y). It is 0 at whole x and y, has a standard deviation of 1/3, and is almost
/// never beyond 1.
/// Method: [musgrave1989] section 3.2, after Perlin. Departures: the gradients are joined by the
///         quintic, because the second derivatives of the paper's cubic jump at lattice lines. They
///         are uniform in a square, which has the spectrum of any isotropic choice.
float gradient_noise(double x, double y, std::uint64_t seed);

/// Terrain whose height at a place depends on the place alone. A part of a canvas, and smaller
/// cells, show the same terrain (laws by position need `patch_m` for this).
/// Method: [musgrave1989] section 3.3. Departures: weights are lacunarity^(-H i), which give the
///         spectrum 1/f^(1 + 2H) of a profile. The printed lacunarity^(-beta i / 2) gives 1/f^(2 +
///         2H), because an octave spreads its power over a band as wide as its frequency. The
///         lattice of each octave is shifted, because otherwise all of them would be 0 at the
///         origin.
/// Cost:   O(cells * octaves). Any number of threads gives the same bits.
/// Throws: std::invalid_argument, Cancelled.
Raster<float> generate_noise(const Canvas& canvas, const NoiseOptions& options = {},
                             const Run& run = {});

/// The height of one place. It has the same bits as that of a canvas with a cell centre there. Laws
/// by position need `patch_m`.
float noise_height_m(double east_m, double north_m, const NoiseOptions& options = {});

}  // namespace dem
