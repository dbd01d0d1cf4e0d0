#pragma once
// Terrain by faulting and collaging [faulting1996]: the sum of many simple displacements.

#include <cstdint>
#include <vector>

#include "dem/canvas.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// How displacements are distributed: +1 or -1, uniform, normal, or two-sided exponential.
/// All have mean 0 and a mean square of 1, and are scaled by the chosen step.
enum class StepLaw { equal, uniform, gaussian, exponential };

/// Options of generate_faults.
struct FaultOptions {
  int count = 10000;
  double relief_m = 600;
  StepLaw steps = StepLaw::gaussian;
  double width_m = 1000;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(FaultOptions& options);

/// Cuts the canvas along random straight lines. One side of each line rises, the other sinks.
/// Method: [faulting1996], line faults. The lines are a Poisson process: every direction, and every
///         distance from the centre out to the corners, is equally likely. Each step is relief_m /
///         sqrt(count), so the standard deviation of the heights is about relief_m. A ramp of
///         width_m joins the sides (0: a cliff).
/// Cost:   O(rows * (count + cols)). In each row a fault is one or two entries of a list of
///         differences, which is summed once. Any number of threads gives the same bits.
/// Throws: std::invalid_argument, Cancelled.
Raster<float> generate_faults(const Canvas& canvas, const FaultOptions& options = {},
                              const Run& run = {});

/// Options of generate_globe.
struct GlobeOptions {
  int count = 5000;
  double relief_m = 3000;
  StepLaw steps = StepLaw::gaussian;
  double off_centre = 0;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(GlobeOptions& options);

/// Cuts a sphere along random circles. One side of each circle rises, the other sinks.
/// Method: [faulting1996], faults along great circles in all directions alike. Great circles make
///         every mountain the mirror image of a deep on the opposite side of the globe. With
///         off_centre > 0 the planes of the circles lie up to off_centre radii from the centre,
///         which removes this symmetry.
/// Needs:  a canvas whose georeference is degrees of longitude and latitude, of any part of the
///         globe.
/// Gives:  heights of the sphere at the cell centres. There is no seam at the antimeridian, and a
///         pole has one height.
/// Cost:   O(rows * (count + cols)), as for generate_faults.
/// Throws: std::invalid_argument, Cancelled.
Raster<float> generate_globe(const Canvas& canvas, const GlobeOptions& options = {},
                             const Run& run = {});

/// The height of a pasted shape. q is the squared distance from the centre over the squared radius.
///   disc and rectangle: 1 inside; cone: 1 - sqrt(q); hump: (1 - q)^2;
///   crater: 1 / (1 + q), everywhere
enum class CollageShape { disc, rectangle, cone, crater, hump };

enum class CollageSign { both, up, down };

/// Options of generate_collage.
struct CollageOptions {
  CollageShape shape = CollageShape::hump;
  int count = 10000;
  double radius_min_m = 150;
  double radius_max_m = 8000;
  double size_exponent = 2.5;
  double step_m = 400;
  double growth = 1;
  StepLaw steps = StepLaw::uniform;
  CollageSign sign = CollageSign::both;
  double aspect = 2;
  std::uint64_t seed = 1;
};
std::vector<Field> fields(CollageOptions& options);

/// Pastes discs, rectangles, cones, craters or elliptical humps of random place, size and height.
/// Method: [faulting1996]; its crater H F / (F + x^2 + y^2) has F = radius^2. Radii r have the
///         density r^-size_exponent. Heights are steps of step_m (r / radius_max_m)^growth. Shapes
///         are up to `aspect` times as long as wide. Rectangles lie along the axes, other shapes
///         are rotated. The centres are as dense up to radius_max_m outside the canvas as on it.
/// Cost:   discs and rectangles O(rows * count + cells), by differences as in generate_faults;
///         cones and humps O(their cells); craters O(count * cells).
/// Throws: std::invalid_argument, Cancelled.
Raster<float> generate_collage(const Canvas& canvas, const CollageOptions& options = {},
                               const Run& run = {});

}  // namespace dem
