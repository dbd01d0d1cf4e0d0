#pragma once
// How rough the terrain is here, against the whole: by it the uncertainty differs from place to
// place. Private to the library.

#include "dem/dem.h"
#include "dem/run.h"
#include "spline/grid.h"

namespace dem::spline {

class Roughness {
 public:
  /// Reads the second differences of a surface at its known cells, as means over blocks of 8 x 8
  /// cells and their neighbours; blocks without data get theirs from those around, by MCMD on the
  /// logarithm. X = (dy / dx)^2. Differences across `breaks` (may be empty) do not count.
  Roughness(const Grid<double>& surface, const Mask& known, const Mask& breaks, double X,
            const Run& run);

  /// The RMS of the second differences around a cell over that of all known cells.
  double at(int col, int row) const;

 private:
  Raster<float> log_;  // by block: 2 log of what at() returns
};

}  // namespace dem::spline
