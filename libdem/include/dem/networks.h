#pragma once
// Ridges and rivers first: skeletons of known cells, and the terrain around them.

#include <cstdint>
#include <vector>

#include "dem/canvas.h"
#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/mcmd.h"
#include "dem/river.h"
#include "dem/run.h"

namespace dem {

/// A skeleton DEM. Its known cells are those of ridges and rivers only.
struct Skeleton {
  Dem dem;
  Raster<CellKind> kinds;  ///< ridge or river; plain where unknown
  std::vector<River> rivers;
};

/// Options of grow_skeleton. Lengths that are not in cells are parts of the longer side of the map.
struct NetworkOptions {
  int ridges = 12;
  int springs = 120;
  double ridge_height_m = 1200;
  double ridge_variation = 0.5;
  double ridge_length = 0.12;
  double ridge_width = 0.5;
  double ridge_wander = 0.12;
  double ridge_H = 0.9;
  double dome = 0.08;
  double friction = 40;
  double river_depth_m = 4;
  double river_width_m = 15;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(NetworkOptions& options);

/// Grows ridges and the rivers that drain them, on an empty map.
/// Method: [belhadj2005] section 2. Pairs of ridge particles move apart on fractional Brownian
///         paths. Their altitude is a Gaussian of the distance covered, until it is nearly 0 or
///         they meet another ridge. Their Gaussian cross-sections, blended (the highest counts),
///         are the ground. River particles run down this ground with inertia and friction. A
///         particle that meets the path of another stops, and the other continues from there with
///         the velocities and masses of both. Rivers that end inside the map are dropped.
///         Departures: the ground has 257 nodes a side and stands on a dome. Its logarithm pulls
///         the particles, after its basins were filled to their outlets. A path that crosses itself
///         loses the loop. A river whose confluence is removed continues to flow. The altitude
///         along a river is the lowest so far, minus the depth of the bed, which grows with the
///         square root of the mass.
/// Gives:  along every river elevations never rise toward the mouth. A larger map of the same shape
///         shows the same ridges in more detail.
/// Cost:   O(cells), most of it to clear the rasters.
/// Throws: std::invalid_argument, also when no river leaves the map; Cancelled.
Skeleton grow_skeleton(Size size, Spacing spacing, const NetworkOptions& options = {},
                       const Run& run = {});

/// Where the heights of lines that a user drew come from.
enum class LineHeights { generated, given };

/// Options of read_skeleton.
struct SketchLinesOptions {
  LineHeights heights = LineHeights::generated;
  double low_m = 0;
  double high_m = 1200;
  double river_slope = 0.01;
  double ridge_slope = 0.25;
};
std::vector<Field> fields(SketchLinesOptions& options);

/// Reads ridges and rivers from a drawing. White (from 0.98) is empty. The lighter half of the
/// greys, [0.5, 0.98), are ridges, the darker half, [0, 0.5), are rivers.
/// Heights: given: the grey, from low_m (black) to high_m (white). A river cell that is lower than
///          the next one toward its mouth is raised to it. generated: rivers rise from their mouths
///          by river_slope. Ridges stand above the nearest river or edge of the map by ridge_slope
///          times its distance, up to high_m.
/// Mouths:  the river cells on the edge of the map. If a river does not reach it, its mouth is the
///          cell nearest to it.
/// Gives:   along every river elevations never rise toward the mouth.
/// Throws:  std::invalid_argument when the drawing has no line, or no white; Cancelled.
Skeleton read_skeleton(const Raster<float>& drawing, Spacing spacing,
                       const SketchLinesOptions& options = {}, const Run& run = {});

/// The method that fills the terrain around a skeleton.
enum class SkeletonFill { mcmd, mdi };

/// Options of fill_skeleton.
struct SkeletonFillOptions {
  SkeletonFill fill = SkeletonFill::mcmd;
  double I_bu = 5;
  double I = 0;
  double I_bu_ridge = 5;
  double I_ridge = 0;
  double I_bu_river = 0;
  double I_river = 0;
  double H = 0.35;
  double rt = 0;
  double rs = 0.06;
  double rs_bu = 0.05;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(SkeletonFillOptions& options);

/// Fills the terrain around a skeleton, whose cells stay the same, bit for bit.
/// Method: `mcmd`, the default: [belhadj2007] figure 11, with separate I and I_bu for ridges and
///         rivers. `mdi`: [belhadj2005], MDI then MD. MCMD is the default because its bends make
///         ridges sharp and valleys round. The heights of MDI between lines are plain means.
/// Needs:  at least one known cell.
/// Cost:   that of fill_mcmd or fill_mdi.
/// Throws: std::invalid_argument, Cancelled.
Raster<float> fill_skeleton(const Skeleton& skeleton, const SkeletonFillOptions& options = {},
                            const Run& run = {});

/// Options of generate_ridges. The seed of the network is also that of the fill.
struct RidgesOptions {
  NetworkOptions network;
  SkeletonFillOptions fill;
};
std::vector<Field> fields(RidgesOptions& options);

/// A terrain around random ridges and rivers: fill_skeleton of grow_skeleton.
Raster<float> generate_ridges(const Canvas& canvas, const RidgesOptions& options = {},
                              const Run& run = {});

/// Options of generate_skeleton.
struct DrawnSkeletonOptions {
  SketchLinesOptions lines;
  SkeletonFillOptions fill;
};
std::vector<Field> fields(DrawnSkeletonOptions& options);

/// A terrain around drawn ridges and rivers: fill_skeleton of read_skeleton.
Raster<float> generate_skeleton(const Canvas& canvas, const Raster<float>& drawing,
                                const DrawnSkeletonOptions& options = {}, const Run& run = {});

}  // namespace dem
