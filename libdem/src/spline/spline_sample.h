#pragma once
// Random surfaces with the spline's own spectrum: what the uncertainty is read from.
// Private to the library.

#include <cstdint>

#include "dem/raster.h"
#include "spline/grid.h"
#include "spline/springs.h"

namespace dem::spline {

/// Right-hand side whose solution, 0 at fixed cells, is one draw from the springs' distribution:
/// each spring pulled by a standard normal number, and each data weight of `w` (may be empty) by
/// one more. Springs across `breaks` (may be empty) are cut.
Grid<float> spring_noise(const Springs& springs, const Mask& breaks, Size size,
                         const Grid<float>& w, std::uint64_t seed, int index);

/// The energy of a surface: sum of c_ij ||Dx^i Dy^j z||^2 over the springs that are not cut.
double spring_energy(const Springs& springs, const Mask& breaks, const Grid<double>& z);

/// Variance as a function of the distance to data, from samples: means in logarithmic bins, made
/// to grow with the distance.
class DistanceLaw {
 public:
  /// Adds the squares of one sample. `distance` in fifths of a cell; 0 is left out.
  void add(const Grid<double>& sample, const Raster<std::uint16_t>& distance);
  void finish();
  double variance(double fifths) const;

 private:
  static constexpr std::size_t bins = 40;
  static std::size_t bin_of(std::uint16_t fifths);
  std::array<double, bins> sum_{}, count_{}, mean_{}, centre_{};
};

}  // namespace dem::spline
