#pragma once
// What geodesy needs to know of a coordinate system. Private to dem::io.

#include <string>

namespace dem::io {

struct CrsUnits {
  bool geographic = false;
  double unit = 1;  ///< degrees (geographic) or metres in one unit of the coordinates
  double equatorial_radius_m = 0, flattening = 0;
};

/// Throws std::invalid_argument when the text is no coordinate system. Empty: metres.
CrsUnits crs_units(const std::string& wkt);

}  // namespace dem::io
