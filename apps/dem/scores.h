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
  const char* title;  ///< in a report
};
inline constexpr Measure kMeasures[] = {
    {"rmse", "m", &Errors::rmse_m, "RMSE"},
    {"mae", "m", &Errors::mae_m, "mean of |error|"},
    {"bias", "m", &Errors::bias_m, "bias"},
    {"nmad", "m", &Errors::nmad_m, "NMAD"},
    {"le90", "m", &Errors::le90_m, "LE90"},
    {"max", "m", &Errors::max_m, "largest |error|"},
    {"slope_rmse", "deg", &Errors::slope_rmse_deg, "RMSE of slope"}};

/// How well a standard deviation foretold the errors, over cells where it is above 0.
struct Calibration {
  std::size_t cells = 0;
  double within_1 = 0, within_2 = 0, within_3 = 0;  ///< part of |e| <= 1, 2, 3 sigma
  double rms_ratio = 0;                             ///< root mean square of e / sigma
};
Calibration calibration(const Raster<float>& truth, const Raster<float>& got, const Mask& judged,
                        const Raster<float>& sigma);

struct Scores {
  Errors all;
  std::optional<Errors> filled;
  std::size_t unfilled = 0;  ///< cells of the truth that the reconstruction does not know
  std::vector<SpectrumBin> truth, got;
  std::optional<Calibration> calibration;
};

/// Cells that both know.
Mask known_in_both(const Dem& a, const Dem& b);

/// Those of `comparable` that `sampled` does not know.
Mask without_known(const Mask& comparable, const Dem& sampled);

/// Errors over the `comparable` cells, and over the `filled` ones (may be empty: not asked for);
/// calibration of the standard deviations `sigma` over these (may be empty: not asked for);
/// spectra where both surfaces are whole and at least 16 x 16 cells.
/// Needs: rasters and masks of one size, each mask with a cell.
Scores score(const Dem& truth, const Dem& got, const Mask& comparable, const Mask& filled,
             const Raster<float>& sigma, const Run& run);

/// Errors and spectra, as `dem evaluate --json` prints them.
Json as_json(const Scores& scores);

}  // namespace dem::app
