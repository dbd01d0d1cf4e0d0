#pragma once
// The terrain spline: the smoothest surface through the known cells. "Smooth" weighs first, second
// and third differences so that the surface has the spectrum of terrain.

#include <cstdint>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// Where the lengths L1 and L3 come from: from the DEM, or from the options.
enum class SplineParameters { automatic, manual };

/// What Filled::sigma contains: nothing, a variance that depends on the distance to data, or the
/// spread of `realisations` random surfaces.
enum class SplineSigma { none, law, simulation };

/// Options of fill_spline. The energy is the sum over 1 <= i + j <= 3 of c_ij ||Dx^i Dy^j z||^2.
/// Its symbol is a1 K + a2 K^2 + a3 K^3, where K is the squared wavenumber per row. Lengths are in
/// rows.
struct SplineOptions {
  SplineParameters parameters = SplineParameters::automatic;
  /// Membrane for waves longer than this: a1 = (2 pi / L1)^2; 0: none.
  double L1_rows = 64;
  /// Third order for waves shorter than this: a3 = (L3 / 2 pi)^2; 0: none.
  double L3_rows = 7;
  /// Weight of the plate.
  double a2 = 1;
  /// Fourth-order accurate wavenumbers, g + g^2 / 12. If false: g = 2 - 2 cos k, for rough ground.
  bool fourth_order = true;
  /// Variance of the noise of the data over that of the springs; 0: known cells are met exactly.
  double nugget = 0;
  /// With a nugget: whether known cells return smoothed.
  bool smooth_known = false;
  /// Second-order springs bend with the terrain: ridges and valleys continue through gaps.
  bool adaptive = true;
  /// Radius around a cell in which its bending is read; 0: the mean distance between known cells.
  double adaptive_sigma_cells = 0;
  /// Stop when the estimated RMS error against the converged solution is below this; 0: 3 % of the
  /// change.
  double tolerance_m = 0;
  int max_iterations = 100;
  SplineSigma sigma = SplineSigma::none;
  /// Number of random surfaces for sigma = simulation.
  int realisations = 16;
  /// Return the k-th random surface through the data, as rough as the terrain; 0: the spline.
  int realisation = 0;
  /// Roughness of a realisation, relative to that of the terrain around each void; 0: smooth.
  double roughness = 1;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(SplineOptions& options);

/// Throws std::invalid_argument for a value out of its range, and for lengths that are set while
/// they are chosen from the DEM.
void check_settings(const SplineOptions& options);

/// Whether fill_spline gives a standard error with these options.
bool gives_sigma(const SplineOptions& options);

/// A filled DEM, and the springs that it was filled with.
struct SplineFilled : Filled {
  double L1_rows = 0, L3_rows = 0;
  bool fourth_order = true;
  double scale_m = 0;  ///< of the springs; 0 unless sigma or a realisation was asked for
};

/// Fills every unknown cell with the terrain spline.
/// Method:   springs of orders one to three with free boundaries, after [szeliski1989] and
///           [smith1990] (a membrane and a plate). They act on the known cells minus their
///           least-squares plane, whose slopes shrink with the variance that it explains. The
///           solver is the conjugate gradient method, preconditioned by one multigrid V-cycle and
///           started from MCMD. Where the data leave wide gaps, L1 is halved until the surface
///           stays in the range of the data around it. With a nugget, known cells pull by springs
///           and are not met exactly.
/// Needs:    at least one known cell.
/// Gives:    all finite; known cells bit for bit (unless smooth_known). The report has iterations,
///           estimated_error, residual, the parameters used, and `converged` (1 or 0).
/// Exact on: constants; planes, to rounding.
/// Sigma:    from surfaces drawn from the distribution of the springs. It is scaled by the local
///           roughness (the second differences of the result at known cells around), by the energy
///           of the result per known cell and, with automatic parameters, by the errors of hidden
///           known cells: 72 % of them lie within one sigma (figures inside_1_sigma,
///           inside_2_sigma).
/// Cost:     O(cells), about 40 bytes a cell in addition to the result, 12 more when adaptive. Any
///           number of threads gives the same bits.
/// Throws:   std::invalid_argument, Cancelled.
SplineFilled fill_spline(const Dem& dem, const SplineOptions& options = {}, const Run& run = {});

/// The same with noise that differs from cell to cell. `noise` has the size of the DEM and
/// multiplies the nugget (1: unchanged; 0: this cell is exact).
SplineFilled fill_spline(const Dem& dem, const Raster<float>& noise, const SplineOptions& options,
                         const Run& run = {});

}  // namespace dem
