#pragma once
// What a report shows of a comparison of two surfaces.

#include <span>
#include <string>
#include <vector>

#include "dem/evaluate.h"
#include "report/page.h"

namespace dem::app {

/// Two surfaces, and what is to be told of their difference.
struct Compared {
  const Raster<float>& truth;  ///< without holes, as is `got`
  const Raster<float>& got;
  const Mask& comparable;  ///< known in both
  const Mask& judged;      ///< those that are scored
  const Errors& errors;    ///< over them
  Mask known{};            ///< what `got` was made from; empty: not said
  Raster<float> sigma{};   ///< foretold standard deviation, 0 where there is none; empty: not said
  std::span<const Spacing> spacing;
  Spacing middle;
};

/// Pictures and charts of the errors, and the spectra of both (which may be empty).
Json error_sections(const Compared& c, const std::vector<SpectrumBin>& truth,
                    const std::vector<SpectrumBin>& got, const Run& run);

}  // namespace dem::app
