#pragma once
// The spline's parameters, chosen from the DEM: by hiding known cells that look like those to be
// filled, and looking which springs find them best. Private to the library.

#include "dem/dem.h"
#include "dem/run.h"

namespace dem::spline {

/// How the known cells lie.
enum class Layout { scattered, clustered, contours };

/// The error of one hidden cell, and how far it was from data (fifths of a cell).
struct HeldOut {
  float error_m;
  std::uint16_t distance;
  int col, row;
};

struct ChosenSprings {
  double L1_rows = 64, L3_rows = 7;
  bool fourth_order = true;
  double nugget = 0;
  Layout layout = Layout::scattered;
  double hidden_rmse_m = 0;  ///< of the cells that were hidden, with the springs chosen
  int hidden_cells = 0;
  std::vector<HeldOut> held_out;  ///< the same, one by one
  double contour_step_m = 0;      ///< between contour lines
  bool as_usual = false;          ///< nothing was tried: a small window around holes
};

/// Tells apart samples that lie at random, samples that leave large gaps, and contour lines.
/// Method: mean distance of unknown cells to data, against that of random samples as dense;
/// contours
///         are lines, and gaps whose rim spans at most one step of the values.
Layout layout_of(const Dem& dem, const Raster<std::uint16_t>& distance);

/// Chooses the springs. `dem`: heights above their plane, 0 where unknown. X = (dy / dx)^2.
/// Method: scattered: a tenth (sparse ones: a fifth) of the known cells hidden in one window of
/// each
///         quadrant. Clustered: disks as wide as the gaps, cut beside them, each in a window of its
///         own; the mean of the logarithms of their errors. Both with a small charge for leaving
///         the usual springs. Fewer than 2^15 cells of which three fifths are known, as around a
///         hole, take the usual springs; their hidden cells are looked at when `errors_wanted`.
ChosenSprings choose_springs(const Dem& dem, Layout layout, const Raster<std::uint16_t>& distance,
                             double X, bool errors_wanted, const Run& run);

}  // namespace dem::spline
