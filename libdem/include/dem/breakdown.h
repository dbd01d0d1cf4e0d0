#pragma once
// Errors broken down: how they spread, and how they depend on slope, on the distance to data, or on
// the standard deviation that was foretold.

#include <cstddef>
#include <span>
#include <vector>

#include "dem/dem.h"

namespace dem {

/// How many values lie in each of some bins of equal width.
struct Histogram {
  double low = 0, high = 0;        ///< the first bin's lower and the last one's upper end
  std::vector<std::size_t> cells;  ///< of each bin; a bin holds its lower end, the last both
  std::size_t below = 0, above = 0;

  double width() const { return (high - low) / double(cells.size()); }
};

/// The histogram of the values where `where` is 1.
/// Throws: std::invalid_argument unless sizes agree, low < high and bins >= 1.
Histogram histogram(const Raster<float>& values, const Mask& where, double low, double high,
                    int bins);

/// Values below which the given parts (0 to 1, in any order) of the cells lie, where `where` is 1:
/// nearest rank.
/// Throws: std::invalid_argument unless sizes agree, a cell is chosen and the parts are in [0, 1].
std::vector<double> quantiles(const Raster<float>& values, const Mask& where,
                              std::span<const double> parts);

/// Errors of the cells where something else lies in [from, to).
struct ErrorClass {
  double from = 0, to = 0;
  std::size_t cells = 0;
  double rmse_m = 0, bias_m = 0;  ///< NaN where there is no cell
  double by_rms = 0;              ///< root mean square of what the classes are made by
};

/// Breaks `error` down by another raster, where `where` is 1. Cells outside all classes count in
/// none.
/// Needs:  `bounds` ascending: n + 1 of them make n classes.
/// Throws: std::invalid_argument.
std::vector<ErrorClass> errors_by(const Raster<float>& error, const Mask& where,
                                  const Raster<float>& by, std::span<const double> bounds);

/// How far each cell is from the nearest known one, between centres, in metres; 0 where known.
/// Method: exact Euclidean distances in two passes [felzenszwalb2012].
/// Cost:   O(cells).
/// Throws: std::invalid_argument when no cell is known or the spacing is not positive.
Raster<float> distance_to_known(const Mask& known, Spacing spacing);

}  // namespace dem
