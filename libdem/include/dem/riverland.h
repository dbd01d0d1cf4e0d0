#pragma once
// RiverLand: rivers grown into painted land, and terrain that drains into them.

#include <cstdint>
#include <vector>

#include "dem/canvas.h"
#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/river.h"
#include "dem/run.h"

namespace dem {

/// What a user painted.
struct Land {
  Mask land;     ///< 1: land, 0: sea; all of it may be land
  Mask rocks{};  ///< 1: a patch of rocky outcrops; empty: none
  std::vector<std::vector<RidgePoint>> ridges{};
};

/// How the ground rises from a river or coast: evenly; from a flat floor; from steep banks; as the
/// walls of a trough; behind a plain as a cliff; in steps.
enum class SlopeProfile { linear, concave, convex, trough, cliffs, terraces };

/// Options of make_riverland, after the steps that they govern.
struct RiverLandOptions {
  // Rivers
  int mouths = 24;
  double mouth_distance_m = 2500;
  int rivers = 150;
  double clearance_m = 450;
  double segment_m = 700;
  int segments = 10;
  double turn = 0.25;
  double meander = 0.6;
  double river_slope = 0.006;
  double head_m = 1200;
  double head_steepness = 4;
  double river_width_m = 12;
  // Land
  double slope = 0.35;
  double slope_variation = 0.5;
  int smoothing = 4;
  double cliff_slope = 0.8;
  SlopeProfile profile = SlopeProfile::concave;
  double profile_m = 200;
  // Overlay
  int overlay_nodes = 33;
  double overlay_relief = 0.07;
  double overlay_H = 0.65;
  double ridge_roughness = 0.2;
  double rock_radius_m = 150;
  double rock_height_m = 120;
  double rock_distance_m = 400;
  double rock_steepness = 3;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(RiverLandOptions& options);

struct RiverLand {
  Raster<float> z;  ///< 0 at sea and along its coast
  std::vector<River> rivers;
  Mask wet;  ///< cells of rivers, as wide as they are
};

/// Makes a terrain of painted land.
/// Method:   [teoh2009]. Mouths at least mouth_distance_m apart; rivers of segments that meander
///           between them, those of the coast before their tributaries; these from concave banks, in
///           random order; levels by average
///           slope, steeper toward the source; PathToRiver pointers and distances with the slope of
///           each river; maximal cells, their ideal heights smoothed; heights in between linear;
///           cliffs removed; a slope profile; user ridges; a fractal overlay that leaves rivers as
///           they are, with rocky outcrops. Departures: where paths from several maximal cells
///           share a cell, their gradients count in the mean; profiles are applied after the cliffs
///           are removed, so that they may make some; in the end what the overlay dammed up is
///           filled to its outlet, so that all land drains.
/// Gives:    from every land cell a path falls, step by step, to a river or the sea; levels fall
///           along every river. Map edges count as coast where there is land.
/// Cost:     O(cells); 40 bytes a cell.
/// Throws:   std::invalid_argument: no land, no room for a river, a ridge off the land; Cancelled.
RiverLand make_riverland(const Land& land, Spacing spacing, const RiverLandOptions& options = {},
                         const Run& run = {});

/// Land as an image shows it: black (below 0.25) is sea, white (from 0.75) land, and the greys
/// between land with rocky outcrops.
Land read_land(const Raster<float>& drawing);

/// An island that fills the map, with a ragged coast.
Land make_island(Size size, std::uint64_t seed = 1, const Run& run = {});

/// The land of generate_riverland.
enum class LandShape { island, whole };

/// Options of generate_riverland.
struct GrownLandOptions {
  LandShape land = LandShape::island;
  RiverLandOptions riverland;
};
std::vector<Field> fields(GrownLandOptions& options);

/// make_riverland on an island, or on the whole map.
Raster<float> generate_riverland(const Canvas& canvas, const GrownLandOptions& options = {},
                                 const Run& run = {});

/// make_riverland on the land of a drawing, as read_land() sees it, with the drawing's ridges.
Raster<float> generate_painted_land(const Canvas& canvas, const Drawing& drawing,
                                    const RiverLandOptions& options = {}, const Run& run = {});

}  // namespace dem
