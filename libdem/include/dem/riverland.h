#pragma once
// RiverLand: rivers that grow into painted land, and terrain that drains into them.

#include <cstdint>
#include <vector>

#include "dem/canvas.h"
#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/river.h"
#include "dem/run.h"

namespace dem {

/// The land that a user painted.
struct Land {
  Mask land;     ///< 1: land, 0: sea; all of it may be land
  Mask rocks{};  ///< 1: a patch of rocky outcrops; empty: none
  std::vector<std::vector<RidgePoint>> ridges{};
};

/// How the ground rises from a river or coast: evenly; from a flat floor; from steep banks; like
/// the walls of a trough; as a cliff behind a plain; in steps.
enum class SlopeProfile { linear, concave, convex, trough, cliffs, terraces };

/// Options of make_riverland, grouped by the steps that they control.
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
  Mask wet;  ///< cells of rivers, over their full width
};

/// Makes a terrain from painted land.
/// Method: [teoh2009]. Mouths are at least mouth_distance_m apart. Rivers have segments that
///         meander between them. Those of the coast come before their tributaries, which start at
///         concave banks, in random order. Levels follow from an average slope that is steeper
///         toward the source. PathToRiver pointers and distances use the slope of each river. The
///         ideal heights of maximal cells are smoothed, and heights in between are linear. Then
///         come the removal of cliffs, a slope profile, user ridges, and a fractal overlay with
///         rocky outcrops that leaves rivers unchanged. Departures: where paths from several
///         maximal cells share a cell, their gradients count in the mean. Profiles are applied
///         after the removal of cliffs, so they may make new ones. In the end, ground that the
///         overlay dammed up is filled to its outlet, so that all land drains.
/// Gives:  from every land cell a path falls, step by step, to a river or the sea. Levels fall
///         along every river. Edges of the map count as coast where they are land.
/// Cost:   O(cells); 40 bytes a cell.
/// Throws: std::invalid_argument: no land, no room for a river, a ridge outside the land;
///         Cancelled.
RiverLand make_riverland(const Land& land, Spacing spacing, const RiverLandOptions& options = {},
                         const Run& run = {});

/// The land of an image: black (below 0.25) is sea, white (from 0.75) is land, and the greys
/// between are land with rocky outcrops.
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

/// make_riverland on the land of a drawing, as read_land() reads it, with the ridges of the
/// drawing.
Raster<float> generate_painted_land(const Canvas& canvas, const Drawing& drawing,
                                    const RiverLandOptions& options = {}, const Run& run = {});

}  // namespace dem
