#pragma once
// Making a problem from a DEM: each sampler returns the DEM with fewer known cells. Kept cells keep
// their elevation bit for bit (but for sample_contours); cells that were unknown stay unknown; the
// height of an unknown cell is 0, so that no truth leaks. At least one cell stays known: what
// cannot be done so throws std::invalid_argument. A seed gives the same cells on every machine:
// integer and IEEE arithmetic and square roots only.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"

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

/// Cuts SRTM-like voids: ragged blobs, each with the area of a disc of `min_across` to `max_across`
/// cells across (logarithmic), every other one starting on steep ground (chance by squared
/// gradient), until exactly `remove` known cells are gone: the last blob is cut short.
struct VoidOptions {
  std::size_t remove = 0;  ///< less than the known cells there are
  int min_across = 3;      ///< >= 1
  int max_across = 60;     ///< >= min_across
  std::uint64_t seed = 1;
};
std::vector<Field> fields(VoidOptions& options);
Dem sample_voids(const Dem& dem, const VoidOptions& options);

/// Keeps the cells under `tracks` (>= 1) straight lines, each from one side of the raster to
/// another, as a ship's or a satellite's track.
Dem sample_tracks(const Dem& dem, int tracks, std::uint64_t seed = 1);

/// Keeps the cells that a contour line at a multiple of interval_m (> 0) passes: where a level lies
/// between two known neighbours, the nearer one. Its elevation becomes the level, as on a map.
Dem sample_contours(const Dem& dem, double interval_m);

}  // namespace dem
