#include "places.h"

#include "common.h"
#include "dem/io/geodesy.h"

namespace dem::app {

Canvas globe_canvas(Size size) {
  const double dlon = 360.0 / size.cols, dlat = 180.0 / size.rows;
  Canvas canvas{
      size, {}, {{-180 + dlon / 2, dlon, 0, 90 - dlat / 2, 0, -dlat}, crs_wkt("EPSG:4326")}};
  canvas.spacing = middle_spacing(canvas.ref, size);
  return canvas;
}

Canvas plane_canvas(Size size, Spacing spacing, double x, double y, const std::string& crs) {
  Canvas canvas{size, spacing, {{x, 1, 0, y, 0, -1}, crs_wkt(crs)}};
  const Spacing unit = middle_spacing(canvas.ref, {1, 1});
  canvas.ref.to_world[1] = spacing.dx_m / unit.dx_m;
  canvas.ref.to_world[5] = -spacing.dy_m / unit.dy_m;
  return canvas;
}

namespace {

struct Place {
  double x, y, z;
  bool above_ground;
};

Place parse_place(const std::string& option, const std::string& text) {
  const auto must_be =
      "X,Y,Z: the DEM's coordinates and an elevation in metres, or +METRES above ground";
  const auto first = text.find(','), second = text.find(',', first + 1);
  if (first == std::string::npos || second == std::string::npos) refuse(option, text, must_be);
  std::string height = text.substr(second + 1);
  const bool above_ground = height.starts_with('+');
  if (above_ground) height.erase(0, 1);
  return {parse_number(option, text.substr(0, first), must_be),
          parse_number(option, text.substr(first + 1, second - first - 1), must_be),
          parse_number(option, height, must_be), above_ground};
}

}  // namespace

void check_place(const std::string& option, const std::string& text) { parse_place(option, text); }

Vec3 place_in(const Dem& dem, const std::string& option, const std::string& text) {
  const auto [x, y, z, above_ground] = parse_place(option, text);
  const auto& w = dem.ref.to_world;
  const double area = w[1] * w[5] - w[2] * w[4];
  const double col = (w[5] * (x - w[0]) - w[2] * (y - w[3])) / area;
  const double row = (w[1] * (y - w[3]) - w[4] * (x - w[0])) / area;
  const Vec3 place{col * dem.spacing.dx_m, -row * dem.spacing.dy_m, z};
  if (!above_ground) return place;
  const auto ground = Heightfield(dem).height(place.x, place.y);
  if (!ground)
    throw std::invalid_argument(fmt::format(
        "{} = {}; there is no known ground below, so Z must be an elevation", option, text));
  return {place.x, place.y, *ground + z};
}

}  // namespace dem::app
