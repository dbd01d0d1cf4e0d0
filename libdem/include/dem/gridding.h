#pragma once
// From points on a lattice to a surface that passes through them where they are.

#include "dem/methods.h"
#include "dem/points.h"

namespace dem {

struct GriddingOptions {
  /// How many times the surface is corrected by what it misses the points by. Each is a fill of its
  /// own. [0, 100]
  int passes = 1;
};
std::vector<Field> fields(GriddingOptions& options);

/// What a surface is at the points it was made from.
struct Misfit {
  std::size_t points = 0;  ///< those off their cell's centre
  double rms_m = 0, max_m = 0;
};

struct Gridded {
  Filled filled;
  Misfit misfit;  ///< of the surface between cells (cubic), after the last pass
};

/// Fills the cells without points by a method of a table, and lets the surface pass through the
/// points off the centre of their cells.
/// Method:   deferred correction: what the filled surface (cubic convolution between cells) misses
///           a point by is added to the height of the point's cell, up to three times what the
///           plane of bin_points moved it by; then the rest is filled again.
///           Points with a sigma, and a method that has FillMethod::fill_noisy: each cell's noise
///           is its sigma, and the cells return smoothed.
/// Gives:    cells with a point on their centre bit for bit (unless points have a sigma).
/// Throws:   std::invalid_argument, Cancelled.
Gridded fill_points(const Binned& binned, const ChosenMethod& method,
                    const GriddingOptions& options = {}, const Run& run = {});

}  // namespace dem
