#pragma once
// Evaluating a reconstruction against the truth: errors, calibration of its standard errors,
// spectra.

#include <optional>
#include <vector>

#include "dem/dem.h"
#include "dem/evaluate.h"
#include "dem/run.h"

namespace dem {

/// A number of Errors with its name.
struct Measure {
  const char* name;
  const char* unit;
  double Errors::*value;
  const char* title;  ///< in words
};
inline constexpr Measure measures[] = {
    {"rmse", "m", &Errors::rmse_m, "RMSE"},
    {"mae", "m", &Errors::mae_m, "mean of |error|"},
    {"bias", "m", &Errors::bias_m, "bias"},
    {"nmad", "m", &Errors::nmad_m, "NMAD"},
    {"le90", "m", &Errors::le90_m, "LE90"},
    {"max", "m", &Errors::max_m, "largest |error|"},
    {"slope_rmse", "deg", &Errors::slope_rmse_deg, "RMSE of slope"}};

/// How well standard errors predicted the errors, over cells where they are above 0.
struct Calibration {
  std::size_t cells = 0;
  double within_1 = 0, within_2 = 0, within_3 = 0;  ///< share of |e| <= 1, 2, 3 sigma
  double rms_ratio = 0;                             ///< root mean square of e / sigma
};

/// Rasters and masks have one size.
Calibration calibration(const Raster<float>& truth, const Raster<float>& got, const Mask& judged,
                        const Raster<float>& sigma);

/// What may be known besides the two surfaces. Each has the size of the truth; null: not known.
struct EvaluationInputs {
  const Dem* sampled = nullptr;          ///< what was filled: its unknown cells are judged
  const Raster<float>* sigma = nullptr;  ///< predicted standard errors in metres
};

struct Evaluation {
  Errors all;                    ///< over the cells known in both
  std::optional<Errors> filled;  ///< over those that `sampled` does not know
  std::size_t unfilled = 0;      ///< cells of the truth that the reconstruction does not know
  std::vector<SpectrumBin> truth, got;  ///< empty unless both are whole and at least 16 x 16 cells
  std::optional<Calibration> calibration;
  Mask comparable;  ///< known in both
  Mask judged;      ///< the filled cells where `sampled` is given, else the comparable ones

  const Errors& judged_errors() const { return filled ? *filled : all; }
};

/// Compares a reconstruction with the truth, cell by cell.
/// Method: compare over the cells known in both; a slope beside a void takes the other's heights.
/// Needs:  Dem::row_spacing of the truth for cells in degrees (read_dem sets it).
/// Cost:   O(cells log cells).
/// Throws: std::invalid_argument when sizes differ, or no cell can be judged; Cancelled.
Evaluation evaluate_dem(const Dem& truth, const Dem& got, const EvaluationInputs& inputs = {},
                        const Run& run = {});

/// Cells known in `whole` and unknown in `sampled`.
Mask removed_cells(const Dem& whole, const Dem& sampled);

/// The heights of `dem`, and those of `other` where it is unknown.
Raster<float> completed(const Dem& dem, const Raster<float>& other);

}  // namespace dem
