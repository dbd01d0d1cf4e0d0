#pragma once
// Removes steps of whole metres from a DEM.

#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

struct DeterraceOptions {
  double bound_m = 0.5;  ///< no cell moves by more
  int passes = 200;      ///< relaxation passes on the finest grid
};
std::vector<Field> fields(DeterraceOptions& options);

struct Deterraced {
  Raster<float> z;  ///< unknown cells are unchanged
  double moved_rms_m = 0, moved_max_m = 0;
};

/// The smoothest surface within `bound_m` of the heights. A DEM that was rounded to whole metres
/// has slopes again between its steps.
/// Method: projected relaxation of the energy of a thin plate (13-point stencil, Jacobi with
///         damping, each cell clamped to its bounds after each step), over a pyramid of coarser
///         grids whose corrections come first. Differences that reach unknown cells, or cells
///         outside the raster, are left out.
/// Gives:  every known cell within the bound.
/// Cost:   O(cells * passes). Any number of threads gives the same bits.
/// Throws: std::invalid_argument, Cancelled.
Deterraced deterrace(const Dem& dem, const DeterraceOptions& options = {}, const Run& run = {});

}  // namespace dem
