#pragma once
// The passes that MCMD, MDI and MD are made of. Private to the library.

#include <array>
#include <cstdint>
#include <optional>

#include "dem/mcmd.h"
#include "dem/run.h"

namespace dem::midpoint {

/// The exponent I of equations 2 and 3, for each CellKind.
using Bend = std::array<double, 3>;

/// Delta(e, d) / e of equations 2 and 3; `part` is d / d_max.
double bend_factor(double exponent, double part);

/// A bottom-up mean: a child at distance d counts d^-weight_exponent, its elevation bent.
struct Pull {
  Bend bend{};
  double weight_exponent = 0;
};

/// Equation 1: (su_rand() + rt) * rs * 2^(-r n H), n = 2.
struct Noise {
  double H = 0.5, rt = 0, rs = 0;
  std::uint64_t seed = 1;
};

/// The noise of MDI's bottom-up means: (mean distance in cells) * scale * uniform[-1, 1].
struct UpNoise {
  double scale = 0;
  std::uint64_t seed = 1;
};

/// What all passes of one fill share.
struct Midpoint {
  const Dem& dem;
  const Raster<CellKind>& kinds;  ///< empty: all plain
  Subdivision subdivision;
  float reference_m;  ///< heights are held relative to it: the zero that bends act on
  Run run;

  /// d_max: the diagonal of the raster in cells.
  double diagonal() const;
};

/// Top-down from the known cells alone (plain MD), coarsest stride first: every unknown cell
/// becomes the mean of its ascendants, plus noise. Unknown roots start at root_m, or at the mean of
/// the known ones when that is not given. Known cells come back bit for bit.
Raster<float> displace(const Midpoint& fill, const Bend& bend, const Noise& noise,
                       std::optional<double> root_m = {});

/// Bottom-up, from the finest stride to the coarsest an unknown ascendant becomes the weighted mean
/// of its known children, once they are complete. Returns the DEM with these ascendants known.
Dem carry_up_by_levels(const Midpoint& fill, const Pull& pull);

/// displace() of carry_up_by_levels(), in one go.
Raster<float> carry_up_and_displace(const Midpoint& fill, const Pull& pull, const Bend& bend,
                                    const Noise& noise);

/// Bottom-up in the waves of [belhadj2007] algorithm 1: every unknown ascendant of a cell of this
/// wave becomes the mean of its known children, and a cell of the next wave.
Dem carry_up_in_waves(const Midpoint& fill, const Pull& pull, const UpNoise& noise);

}  // namespace dem::midpoint
