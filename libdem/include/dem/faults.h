#pragma once
// Terrain by faulting and collaging [faulting1996]: many simple displacements, added up.

#include <cstdint>
#include <vector>

#include "dem/canvas.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// How displacements are distributed, all with mean 0 and mean square 1 of the step asked for:
/// +1 or -1, uniform, normal, or two-sided exponential.
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

/// Cuts the canvas along random straight lines; one side of each rises, the other sinks.
/// Method:   [faulting1996], line faults. The lines are a Poisson process: every direction and every
///           distance from the centre, out to the corners, is as likely as any other; each step is
///           relief_m / sqrt(count), so that heights have about that standard deviation. Over
///           width_m the sides are joined by a ramp (0: a cliff).
/// Cost:     O(rows * (count + cols)): in each row a fault is one or two entries of a list of
///           differences, which is summed once. Any number of threads gives the same bits.
/// Throws:   std::invalid_argument, Cancelled.
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

/// Cuts a sphere along random circles; one side of each rises, the other sinks.
/// Method:   [faulting1996], faults along great circles, all directions alike. Great circles make
///           every mountain the mirror image of a deep on the far side; with off_centre > 0 the
///           planes of the circles lie up to so many radii from the centre, and it is not.
/// Needs:    a canvas whose georeference is degrees of longitude and latitude, of any part of the
///           globe.
/// Gives:    heights of the sphere at the cell centres: no seam at the antimeridian, one height at
///           a pole.
/// Cost:     O(rows * (count + cols)), as generate_faults.
/// Throws:   std::invalid_argument, Cancelled.
Raster<float> generate_globe(const Canvas& canvas, const GlobeOptions& options = {},
                             const Run& run = {});

/// What is pasted: q is the squared distance from the centre over the squared radius.
///   disc 1 and rectangle 1 inside; cone 1 - sqrt(q); hump (1 - q)^2; crater 1 / (1 + q), everywhere
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
/// Method:   [faulting1996]; its crater H F / (F + x^2 + y^2) has F = radius^2. Radii r have the
///           density r^-size_exponent; heights are steps of step_m (r / radius_max_m)^growth; shapes
///           are up to `aspect` times as long as wide (rectangles along the axes, others turned).
///           Centres lie as densely up to radius_max_m outside the canvas as on it.
/// Cost:     discs and rectangles O(rows * count + cells), by differences as generate_faults; cones
///           and humps O(their cells); craters O(count * cells).
/// Throws:   std::invalid_argument, Cancelled.
Raster<float> generate_collage(const Canvas& canvas, const CollageOptions& options = {},
                               const Run& run = {});

}  // namespace dem
