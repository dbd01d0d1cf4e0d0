#pragma once
// Lengths on the ground, by GeographicLib.

#include <string>
#include <vector>

#include "dem/dem.h"

namespace dem {

/// Whether the coordinates are degrees of longitude and latitude.
bool is_geographic(const GeoRef& ref);

/// The coordinate system with a given name: "EPSG:32619" or "32619", WKT, or a PROJ string. ""
/// gives "". Throws std::invalid_argument when it is unknown, or has no plane or geographic
/// coordinates.
std::string crs_wkt(const std::string& name);

/// Size of a cell in metres, one for each row.
/// Geographic: geodesic lengths on the ellipsoid of the CRS, at the centre of the row. Projected:
/// the linear unit of the CRS. Without a CRS, units are metres.
/// Throws std::invalid_argument when the georeference is degenerate (zero or non-finite cell).
std::vector<Spacing> spacing_by_row(const GeoRef& ref, Size size);

/// The spacing of the middle row.
Spacing middle_spacing(const GeoRef& ref, Size size);

/// Sets Dem::spacing and Dem::row_spacing from the georeference.
void set_spacing(Dem& dem);

/// Sets Dem::row_spacing: one for each row when cells are in degrees, else empty.
void set_row_spacing(Dem& dem);

/// Area of the cell at (col, row) in square metres (on the ellipsoid, when geographic).
double cell_area_m2(const GeoRef& ref, int col, int row);

}  // namespace dem
