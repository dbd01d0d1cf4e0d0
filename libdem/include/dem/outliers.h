#pragma once
// Known heights that cannot be meant: undeclared no-data values, wrong units, slips of the pen.

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
  double low_m = 0, high_m = 0;  ///< the range outside which a height counts as one
};

/// Finds known heights far from all others. They are data like others, so no method drops them.
/// Method: the range from the 10 % to the 90 % quantile of the known heights, widened to either side
///         by ten times its width, at least by 9000 m: no terrain on Earth leaves it.
/// Needs:  at least one known cell; `most_named` >= 0.
/// Cost:   O(cells); the quantiles are those of at most a million known cells, evenly taken.
Outliers find_outliers(const Dem& dem, std::size_t most_named = 5);

}  // namespace dem
