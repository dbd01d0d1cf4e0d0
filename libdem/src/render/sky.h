#pragma once
// How much of the sky each cell sees. Private to the ray tracer.

#include "dem/dem.h"
#include "dem/run.h"

namespace dem::render {

/// The share of the sky's light that reaches level ground at each cell, 1 where no ground stands
/// over the horizon, on every `step`-th column and row.
///
/// Method: the mean over 16 directions of the squared cosine of the horizon's angle, found among
///         cells at growing distances up to 40 steps.
struct SkyView {
  SkyView(const Dem& dem, double exaggeration, const Run& run);

  /// The share at any column and row, by bilinear interpolation.
  double operator()(double col, double row) const;

  Raster<float> share;
  int step = 1;
};

}  // namespace dem::render
