#pragma once
// Making a problem from a DEM: each sampler returns the DEM with fewer known cells. Kept cells keep
// their elevation bit for bit (but for sample_contours); cells that were unknown stay unknown.
// A seed gives the same cells on every machine: integer arithmetic and IEEE roots only.

#include <cstddef>
#include <cstdint>

#include "dem/dem.h"

namespace dem {

/// Keeps exactly `keep` of the known cells, every subset equally likely.
/// Throws std::invalid_argument unless 1 <= keep <= known cells.
Dem sample_random(const Dem& dem, std::size_t keep, std::uint64_t seed = 1);

/// Keeps the known cells whose column and row are multiples of `step` (>= 1).
Dem sample_regular(const Dem& dem, int step);

/// Keeps exactly `keep` known cells: those with the strongest Sobel gradient (metric cells), the
/// silhouettes of the terrain. Equal gradients are ordered by a hash of the cell.
/// Method: [belhadj2007] section 4, figure 9 (d): "a silhouette detection ... Sobel".
Dem sample_edges(const Dem& dem, std::size_t keep);

/// Cuts SRTM-like voids: blobs with ragged rims, `min_cells` to `max_cells` across (logarithmic),
/// half of them starting on steep ground, until at least `remove` cells are gone (and at most one
/// blob more, which is cut short: the count is exact).
struct VoidOptions {
  std::size_t remove = 0;
  int min_across = 3;
  int max_across = 60;
  std::uint64_t seed = 1;
};
Dem sample_voids(const Dem& dem, const VoidOptions& options);

/// Keeps the cells under `tracks` straight lines, each from one side of the raster to another, as
/// a ship's or a satellite's track.
Dem sample_tracks(const Dem& dem, int tracks, std::uint64_t seed = 1);

/// Keeps the cells that a contour line at a multiple of interval_m passes: where a level lies
/// between two neighbours, the nearer one. Its elevation becomes the level, as on a contour map.
Dem sample_contours(const Dem& dem, double interval_m);

}  // namespace dem
