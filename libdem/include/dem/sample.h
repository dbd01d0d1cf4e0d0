#pragma once
// Making test problems from a DEM. Each sampler returns the DEM with fewer known cells.
// Kept cells keep their elevation bit for bit (except in sample_contours). Cells that were unknown
// stay unknown. The height of an unknown cell is 0, so the truth cannot leak. At least one cell
// stays known; a request that makes this impossible throws std::invalid_argument. A seed gives the
// same cells on every machine, because only integer and IEEE arithmetic and square roots are used.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"

namespace dem {

/// Keeps exactly `keep` of the known cells. Every subset is equally likely.
/// Throws std::invalid_argument unless 1 <= keep <= known cells.
Dem sample_random(const Dem& dem, std::size_t keep, std::uint64_t seed = 1);

/// Keeps the known cells whose column and row are multiples of `step` (>= 1).
Dem sample_regular(const Dem& dem, int step);

/// Keeps exactly `keep` known cells: those with the strongest Sobel gradient (metric cells), which
/// are the silhouettes of the terrain. Equal gradients are ordered by a hash of the cell.
/// Method: [belhadj2007] section 4, figure 9 (d): "a silhouette detection ... Sobel".
Dem sample_edges(const Dem& dem, std::size_t keep);

/// Cuts voids like those of SRTM, until exactly `remove` known cells are removed.
/// A void is a ragged blob with the area of a disc of `min_across` to `max_across` cells across
/// (logarithmic). Every second blob starts on steep ground (the probability grows with the squared
/// gradient). The last blob is cut short.
struct VoidOptions {
  std::size_t remove = 0;  ///< less than the number of known cells
  int min_across = 3;      ///< >= 1
  int max_across = 60;     ///< >= min_across
  std::uint64_t seed = 1;
};
std::vector<Field> fields(VoidOptions& options);
Dem sample_voids(const Dem& dem, const VoidOptions& options);

/// Keeps the cells under `tracks` (>= 1) straight lines, each from one side of the raster to
/// another, like the tracks of a ship or a satellite.
Dem sample_tracks(const Dem& dem, int tracks, std::uint64_t seed = 1);

/// Keeps the cells that a contour line at a multiple of interval_m (> 0) passes. Where a level lies
/// between two known neighbours, the nearest one is kept. Its elevation becomes the level, as on a
/// map.
Dem sample_contours(const Dem& dem, double interval_m);

}  // namespace dem
