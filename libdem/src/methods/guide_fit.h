#pragma once
// Where auxiliary DEMs lie relative to the raster.

#include <vector>

#include "dem/fill.h"

namespace dem::methods {

/// Sums over known cells of many windows: of d = z - guide on the slopes of z. A shift (u, v) of
/// the guide shows as d = c + u zx + v zy.
class GuideSums {
 public:
  void add(const Dem& dem, const Dem& guide);
  GuideFit fit(const std::string& name) const;

 private:
  double n_ = 0, x_ = 0, y_ = 0, d_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, xd_ = 0, yd_ = 0;
  std::vector<float> offsets_;  // a sample
};

}  // namespace dem::methods
