#pragma once
// Known heights that cannot be right: undeclared nodata values, wrong units, typing errors.

#include <cstddef>
#include <vector>

#include "dem/dem.h"

namespace dem {

struct Outlier {
  int col = 0, row = 0;
  float z = 0;
};

struct Outliers {
  std::size_t count = 0;
  std::vector<Outlier> first;    ///< the first few of them, row by row
  double low_m = 0, high_m = 0;  ///< heights outside this range are outliers
};

/// Finds known heights far from all others. No method drops them: to a method they are data.
/// Method: the range from the 10 % to the 90 % quantile of the known heights, extended on both
///         sides by ten times its width and at least by 9000 m. No terrain on Earth leaves this
///         range.
/// Needs:  at least one known cell; `most_named` >= 0.
/// Cost:   O(cells). The quantiles are those of at most a million known cells, evenly spaced.
Outliers find_outliers(const Dem& dem, std::size_t most_named = 5);

}  // namespace dem
