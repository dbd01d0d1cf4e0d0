#pragma once
// The sparse DEMs that the figures start from.

#include "dem/dem.h"

namespace dem::app {

inline constexpr int kSide = 513;
inline constexpr float kHigh = 0.3F * kSide,
                       kMedium = kHigh / 2;  // the papers do not state a scale

/// A DEM of which no cell is known.
Dem blank(Size size);

/// Makes a cell known, if it lies inside.
void put(Dem& dem, int col, int row, float height);

/// Corners medium, centre high: figures 2 and 3.
Dem five_points();

/// A circle at the highest and four segments on the diagonals at a medium elevation; the segment
/// at the bottom left is shifted by one cell to the left: figures 5 and 8.
Dem circle_and_segments();

/// A few ridges, falling to their sides, and rivers between them, rising to theirs: a skeleton as
/// [belhadj2005] grows it from particles.
Dem skeleton();

}  // namespace dem::app
