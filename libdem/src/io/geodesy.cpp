#include "dem/io/geodesy.h"

#include <fmt/format.h>

#include <GeographicLib/Ellipsoid.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/crs.h"

namespace dem {
using namespace io;
namespace {

using GeographicLib::Ellipsoid;
using GeographicLib::Geodesic;

/// Area of a cell in squared CRS units.
double determinant(const GeoRef& ref) {
  const auto& at = ref.to_world;
  return std::abs(at[1] * at[5] - at[2] * at[4]);
}

void check_ref(const GeoRef& ref) {
  const bool finite = std::ranges::all_of(ref.to_world, [](double v) { return std::isfinite(v); });
  if (!finite || !(determinant(ref) > 0))
    throw std::invalid_argument(
        fmt::format("to_world = ({}); must be finite, with cells that have an area",
                    fmt::join(ref.to_world, ", ")));
}

/// A stretch of a meridian around a row, in degrees, cut at the poles.
struct Stretch {
  double south, north, uncut;
  double cut() const { return north - south; }
  double middle() const { return (north + south) / 2; }
};

/// The row's own latitudes: half a cell to either side of its centre.
Stretch row_stretch(const GeoRef& ref, double unit, double col, double row) {
  const auto& at = ref.to_world;
  const double lat = (at[3] + at[4] * col + at[5] * row) * unit;
  const double half = 0.5 * (std::abs(at[4]) + std::abs(at[5])) * unit;
  if (std::abs(lat) >= 90 + half)
    throw std::invalid_argument(
        fmt::format("row {} lies at latitude {}; must be in [-90, 90]", row, lat));
  return {std::max(lat - half, -90.0), std::min(lat + half, 90.0), 2 * half};
}

double geodesic_m(const Geodesic& earth, double lat1, double lon1, double lat2, double lon2) {
  double length = 0;
  earth.Inverse(lat1, lon1, lat2, lon2, length);
  return length;
}

/// The cell at (col, row) of a geographic grid. A row cut by a pole is measured in the middle of
/// what remains of it, so its width is small but not zero.
Spacing geographic_spacing(const Geodesic& earth, const GeoRef& ref, double unit, double col,
                           double row) {
  const auto& at = ref.to_world;
  const Stretch s = row_stretch(ref, unit, col, row);
  const double per_lat = geodesic_m(earth, s.south, 0, s.north, 0) / s.cut();
  const double lon = std::abs(at[1]) * unit, east_lat = at[4] * unit;
  const double south_lon = at[2] * unit, south_lat = at[5] * unit;
  const double per_lon = lon > 0 ? geodesic_m(earth, s.middle(), 0, s.middle(), lon) / lon : 0;
  if (east_lat == 0 && south_lon == 0) return {lon * per_lon, std::abs(south_lat) * per_lat};

  // Turned grid: along its own two axes, in the plane that touches here.
  const double turned_per_lon = geodesic_m(earth, s.middle(), 0, s.middle(), s.uncut) / s.uncut;
  return {std::hypot(lon * turned_per_lon, east_lat * per_lat),
          std::hypot(south_lon * turned_per_lon, south_lat * per_lat)};
}

Spacing projected_spacing(const GeoRef& ref, double unit) {
  const auto& at = ref.to_world;
  return {std::hypot(at[1], at[4]) * unit, std::hypot(at[2], at[5]) * unit};
}

}  // namespace

bool is_geographic(const GeoRef& ref) { return crs_units(ref.crs_wkt).geographic; }

std::vector<Spacing> spacing_by_row(const GeoRef& ref, Size size) {
  check_ref(ref);
  const CrsUnits crs = crs_units(ref.crs_wkt);
  std::vector<Spacing> spacing(std::size_t(size.rows));
  if (!crs.geographic) {
    std::ranges::fill(spacing, projected_spacing(ref, crs.unit));
    return spacing;
  }
  const Geodesic earth(crs.equatorial_radius_m, crs.flattening);
  for (int row = 0; row < size.rows; ++row)
    spacing[std::size_t(row)] =
        geographic_spacing(earth, ref, crs.unit, (size.cols - 1) / 2.0, row);
  return spacing;
}

Spacing middle_spacing(const GeoRef& ref, Size size) {
  check_ref(ref);
  const CrsUnits crs = crs_units(ref.crs_wkt);
  if (!crs.geographic) return projected_spacing(ref, crs.unit);
  const Geodesic earth(crs.equatorial_radius_m, crs.flattening);
  return geographic_spacing(earth, ref, crs.unit, (size.cols - 1) / 2.0, (size.rows - 1) / 2.0);
}

void set_spacing(Dem& dem) {
  dem.spacing = middle_spacing(dem.ref, dem.size());
  set_row_spacing(dem);
}

void set_row_spacing(Dem& dem) {
  dem.row_spacing.clear();
  if (is_geographic(dem.ref)) dem.row_spacing = spacing_by_row(dem.ref, dem.size());
}

double cell_area_m2(const GeoRef& ref, int col, int row) {
  check_ref(ref);
  const CrsUnits crs = crs_units(ref.crs_wkt);
  const double area = determinant(ref) * crs.unit * crs.unit;
  if (!crs.geographic) return area;

  // The zone between two parallels, by authalic latitudes, spread over its square degrees.
  const Ellipsoid earth(crs.equatorial_radius_m, crs.flattening);
  const Stretch s = row_stretch(ref, crs.unit, col, row);
  const auto sine = [&](double lat) {
    return std::sin(earth.AuthalicLatitude(lat) * GeographicLib::Math::degree());
  };
  const double zone_m2 = earth.Area() / 2 * (sine(s.north) - sine(s.south));
  return zone_m2 * area / (360 * s.uncut);
}

}  // namespace dem
