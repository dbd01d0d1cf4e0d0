#include "dem/io/places.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "dem/io/geodesy.h"

namespace dem {
namespace {

constexpr auto a_place =
    "X,Y,Z: the DEM's coordinates and an elevation in metres, or +METRES above ground";

/// The three numbers of "X,Y,Z", and whether Z counts from the ground.
struct Place {
  double x = 0, y = 0, z = 0;
  bool above_ground = false;
};

Place parse_place(const std::string& name, const std::string& text) {
  const auto refuse = [&] {
    throw std::invalid_argument(fmt::format("{} = {}; must be {}", name, text, a_place));
  };
  const auto number = [&](std::string_view part) {
    double value = 0;
    const char* const last = part.data() + part.size();
    const auto [end, error] = std::from_chars(part.data(), last, value);
    if (error != std::errc() || end != last || !std::isfinite(value)) refuse();
    return value;
  };
  const std::string_view all = text;
  const auto first = all.find(','), second = all.find(',', first + 1);
  if (first == all.npos || second == all.npos) refuse();
  std::string_view height = all.substr(second + 1);
  const bool above_ground = height.starts_with('+');
  if (above_ground) height.remove_prefix(1);
  return {number(all.substr(0, first)), number(all.substr(first + 1, second - first - 1)),
          number(height), above_ground};
}

}  // namespace

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

void check_place(const std::string& name, const std::string& text) { parse_place(name, text); }

Vec3 place_in(const Dem& dem, const std::string& name, const std::string& text) {
  const auto [x, y, z, above_ground] = parse_place(name, text);
  const auto& w = dem.ref.to_world;
  const double area = w[1] * w[5] - w[2] * w[4];
  const double col = (w[5] * (x - w[0]) - w[2] * (y - w[3])) / area;
  const double row = (w[1] * (y - w[3]) - w[4] * (x - w[0])) / area;
  const Vec3 place{col * dem.spacing.dx_m, -row * dem.spacing.dy_m, z};
  if (!above_ground) return place;
  const auto ground = Heightfield(dem).height(place.x, place.y);
  if (!ground)
    throw std::invalid_argument(fmt::format(
        "{} = {}; there is no known ground below, so Z must be an elevation", name, text));
  return {place.x, place.y, *ground + z};
}

}  // namespace dem
