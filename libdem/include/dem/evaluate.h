#pragma once
// How good a reconstruction is: errors of heights, of slopes, and the spectrum of the surface.

#include <cstddef>
#include <span>
#include <vector>

#include "dem/dem.h"
#include "dem/run.h"

namespace dem {

/// Errors of elevation, got - truth, in metres, over a set of cells.
struct Errors {
  std::size_t cells = 0;
  double rmse_m = 0;          ///< root of the mean square
  double mae_m = 0;           ///< mean of |e|
  double bias_m = 0;          ///< mean of e
  double nmad_m = 0;          ///< 1.4826 * median |e - median e|
  double le90_m = 0;          ///< 90 % of |e| are not larger (nearest rank)
  double max_m = 0;           ///< largest |e|
  double slope_rmse_deg = 0;  ///< of Horn's slope, over cells with eight neighbours; NaN: none
};

/// Compares two rasters over the cells where `where` is 1. Sums are in double, row by row. A slope
/// needs the neighbours' heights: both rasters must be without holes, also where `where` is 0.
/// `spacing`: one for all rows, or one for each row (dem/geodesy.h).
/// Throws:  std::invalid_argument when sizes differ or `where` is empty of cells, Cancelled.
Errors compare(const Raster<float>& truth, const Raster<float>& got, const Mask& where,
               std::span<const Spacing> spacing, const Run& run = {});

/// Horn's slope of the surface in degrees, in the size of z; 0 on the outermost ring.
/// Method: [horn1981], 3 x 3 weights 1 2 1, metric cells.
Raster<float> slope_deg(const Raster<float>& z, std::span<const Spacing> spacing,
                        const Run& run = {});

/// One ring of a radially averaged power spectrum.
struct SpectrumBin {
  double wavelength_m = 0;  ///< of the bin's middle
  double power_m2 = 0;      ///< mean power density, m^2 per (cycle/m)^2, i.e. m^4
  std::size_t waves = 0;    ///< how many waves were averaged
};

/// Radially averaged power spectrum of a surface: plane removed, Hann window, FFT of the largest
/// part (from the north-west corner) whose sides have no prime factor above 7. The power is divided
/// by the window's mean square: white noise of variance s^2 has the power s^2 dx dy at every wave.
/// Bins are logarithmic, `per_octave` (>= 1) to a factor of two of the wavelength, the first around
/// the longer side; waves shorter than two of the longer cell side, and empty bins, are left out.
/// Throws: std::invalid_argument for an empty raster, a bad spacing or per_octave.
std::vector<SpectrumBin> power_spectrum(const Raster<float>& z, Spacing spacing,
                                        int per_octave = 2);

/// The exponent beta of power ~ wavenumber^-beta, by least squares of the logarithms over the bins
/// between two wavelengths in metres; NaN when fewer than two bins lie there.
double spectral_slope(std::span<const SpectrumBin> spectrum, double shortest_m, double longest_m);

}  // namespace dem
