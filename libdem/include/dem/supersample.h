#pragma once
// A DEM on a finer lattice.

#include "dem/methods.h"
#include "dem/points.h"

namespace dem {

/// What the finer DEM keeps of the coarse one.
enum class Preserve {
  heights,  ///< the surface passes through the coarse heights, at the coarse cells' centres
  means,    ///< the mean over each coarse cell is its height
};

struct SupersampleOptions {
  double factor = 2;  ///< how many times finer, along either axis: 2 halves the cell size; above 1
  Preserve preserve = Preserve::heights;
  /// Nodes: the outer fine cells have the centres of the outer coarse ones. Otherwise both lattices
  /// have the same outer edges.
  bool nodes = false;
};
std::vector<Field> fields(SupersampleOptions& options);

/// The finer lattice. Its cell size is as close to 1 / factor of the coarse one as whole numbers of
/// columns and rows allow.
/// Throws std::invalid_argument unless factor is above 1 and the lattice has less than 2^31 cells.
Lattice finer_lattice(const Dem& dem, const SupersampleOptions& options);

struct Supersampled {
  Filled filled;
  double miss_rms_m = 0, miss_max_m = 0;  ///< difference from the heights or means to keep
};

/// The DEM on the finer lattice. Its unknown cells are filled too.
/// Method:   coarse heights are points of the finer lattice (bin_points, fill_points). Means are
///           restored by an iterated correction: the cubic surface through the differences of the
///           block means is added, until no mean differs by more than a thousandth of a metre.
/// Exact on: planes; coarse heights at fine cells with the same centre, bit for bit (heights).
/// Throws:   std::invalid_argument, Cancelled.
Supersampled supersample(const Dem& dem, const ChosenMethod& method,
                         const SupersampleOptions& options = {}, const Run& run = {});

}  // namespace dem
