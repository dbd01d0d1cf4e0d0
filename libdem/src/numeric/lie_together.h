#pragma once
// Whether known cells lie along lines. Private to the library.

#include <cmath>
#include <utility>

#include "dem/raster.h"

namespace dem::numeric {

/// Whether known cells have more known neighbours than cells that lie at random: as along lines.
/// At random a cell knows 8 * density of its neighbours, give or take a part 1 / sqrt(pairs).
inline bool lie_together(const Mask& mask) {
  double pairs = 0, known = 0;
  for (int row = 0; row < mask.rows(); ++row)
    for (int col = 0; col < mask.cols(); ++col) {
      if (!mask(col, row)) continue;
      ++known;
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 1}, {0, 1}, {1, 1}})
        if (mask.contains(col + dx, row + dy)) pairs += mask(col + dx, row + dy) != 0;
    }
  if (pairs == 0) return false;
  const double at_random = 4 * known * known / double(mask.size().cells());
  return pairs > at_random * (1 + 5 / std::sqrt(pairs));
}

}  // namespace dem::numeric
