#pragma once
// The place of generated terrain, and places given as text.

#include <string>

#include "dem/canvas.h"
#include "dem/raytrace.h"

namespace dem {

/// The whole Earth in degrees (EPSG:4326), cells centred half a cell from the antimeridian and the
/// poles.
Canvas globe_canvas(Size size);

/// Cells of a size in metres. The north-west cell has its centre at (x, y), in the units of the
/// coordinate system. In degrees (or feet), a cell has the width and height that are this long
/// there. `crs`: "EPSG:32619", WKT, a PROJ string, or "".
/// Throws std::invalid_argument when the coordinate system is unknown.
Canvas plane_canvas(Size size, Spacing spacing, double x, double y, const std::string& crs);

/// Throws std::invalid_argument `name = text; must be ...` unless the text is a place: to be asked
/// before a DEM is read.
void check_place(const std::string& name, const std::string& text);

/// "X,Y,Z" in the coordinates of the DEM and metres. "+200" for Z is 200 m above the ground there.
/// Throws std::invalid_argument `name = text; must be ...`.
Vec3 place_in(const Dem& dem, const std::string& name, const std::string& text);

}  // namespace dem
