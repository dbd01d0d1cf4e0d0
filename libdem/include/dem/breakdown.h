#pragma once
// Errors by class: their distribution, and how they depend on slope, on the distance to data, or on
// the predicted standard error.

#include <cstddef>
#include <span>
#include <vector>

#include "dem/dem.h"

namespace dem {

/// The number of values in each of several bins of equal width.
struct Histogram {
  double low = 0, high = 0;        ///< lower end of the first bin, upper end of the last
  std::vector<std::size_t> cells;  ///< in each bin; a bin includes its lower end, the last one both
  std::size_t below = 0, above = 0;

  double width() const { return (high - low) / double(cells.size()); }
};

/// The histogram of the values where `where` is 1.
/// Throws: std::invalid_argument unless sizes agree, low < high and bins >= 1.
Histogram histogram(const Raster<float>& values, const Mask& where, double low, double high,
                    int bins);

/// The quantiles of the cells where `where` is 1, by nearest rank.
/// `parts` are numbers from 0 to 1, in any order.
/// Throws: std::invalid_argument unless sizes agree, at least one cell is chosen and the parts are
///         in [0, 1].
std::vector<double> quantiles(const Raster<float>& values, const Mask& where,
                              std::span<const double> parts);

/// The errors of the cells whose value in another raster lies in [from, to).
struct ErrorClass {
  double from = 0, to = 0;
  std::size_t cells = 0;
  double rmse_m = 0, bias_m = 0;  ///< NaN when the class has no cell
  double by_rms = 0;              ///< root mean square of the values that define the class
};

/// Groups `error` by the values of another raster, where `where` is 1.
/// Cells outside all classes are not counted.
/// Needs:  `bounds` in ascending order; n + 1 bounds make n classes.
/// Throws: std::invalid_argument.
std::vector<ErrorClass> errors_by(const Raster<float>& error, const Mask& where,
                                  const Raster<float>& by, std::span<const double> bounds);

/// The distance of each cell to the nearest known one, between centres, in metres. It is 0 at known
/// cells.
/// Method: exact Euclidean distances in two passes [felzenszwalb2012].
/// Cost:   O(cells).
/// Throws: std::invalid_argument when no cell is known or the spacing is not positive.
Raster<float> distance_to_known(const Mask& known, Spacing spacing);

}  // namespace dem
