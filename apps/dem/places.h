#pragma once
// Where made terrain lies, and where a camera stands.

#include <string>

#include "dem/canvas.h"
#include "dem/raytrace.h"

namespace dem::app {

/// The whole Earth in degrees (EPSG:4326), cells centred half a cell from the antimeridian and the
/// poles.
Canvas globe_canvas(Size size);

/// Cells of so many metres, the north-west one centred at (x, y) in the CRS's units. In degrees (or
/// feet), the cell is what spans so many metres there. `crs`: "EPSG:32619", WKT, PROJ's words or
/// "".
Canvas plane_canvas(Size size, Spacing spacing, double x, double y, const std::string& crs);

/// Throws std::invalid_argument unless the text has the form that place_in takes.
void check_place(const std::string& option, const std::string& text);

/// "X,Y,Z" in the coordinates of the DEM and metres; "+200" for Z is 200 m above the ground there.
/// Throws std::invalid_argument that names `option`.
Vec3 place_in(const Dem& dem, const std::string& option, const std::string& text);

}  // namespace dem::app
