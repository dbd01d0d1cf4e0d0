#pragma once
// What is measured of a reconstruction: errors over sets of cells, and spectra.

#include <optional>
#include <vector>

#include "common.h"
#include "dem/evaluate.h"

namespace dem::app {

/// A number of Errors, as --expect and the tables name it.
struct Measure {
  const char* name;
  const char* unit;
  double Errors::*value;
};
inline constexpr Measure kMeasures[] = {{"rmse", "m", &Errors::rmse_m},
                                        {"mae", "m", &Errors::mae_m},
                                        {"bias", "m", &Errors::bias_m},
                                        {"nmad", "m", &Errors::nmad_m},
                                        {"le90", "m", &Errors::le90_m},
                                        {"max", "m", &Errors::max_m},
                                        {"slope_rmse", "deg", &Errors::slope_rmse_deg}};

struct Scores {
  Errors all;
  std::optional<Errors> filled;
  std::size_t unfilled = 0;  ///< cells of the truth that the reconstruction does not know
  std::vector<SpectrumBin> truth, got;
};

/// Cells that both know.
Mask known_in_both(const Dem& a, const Dem& b);

/// Those of `comparable` that `sampled` does not know.
Mask without_known(const Mask& comparable, const Dem& sampled);

/// Errors over the `comparable` cells, and over the `filled` ones (may be empty: not asked for);
/// spectra where both surfaces are whole and at least 16 x 16 cells.
/// Needs: rasters and masks of one size, each mask with a cell.
Scores score(const Dem& truth, const Dem& got, const Mask& comparable, const Mask& filled,
             const Run& run);

/// Errors and spectra, as `dem evaluate --json` prints them.
Json as_json(const Scores& scores);

}  // namespace dem::app
