#include "io/crs.h"

#include <fmt/format.h>
#include <ogr_spatialref.h>

#include <memory>
#include <numbers>
#include <stdexcept>

#include "dem/io/geodesy.h"
#include "io/gdal_support.h"

namespace dem::io {
namespace {

CrsUnits parse(const std::string& wkt) {
  const GdalErrors quiet;
  OGRSpatialReference crs;
  if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
    throw std::invalid_argument(
        fmt::format("crs_wkt = {}...; must be a coordinate system in WKT", wkt.substr(0, 40)));
  CrsUnits units;
  units.geographic = crs.IsGeographic() != 0;
  if (units.geographic) {
    units.unit = crs.GetAngularUnits() * 180 / std::numbers::pi;
    units.equatorial_radius_m = crs.GetSemiMajor();
    const double inverse = crs.GetInvFlattening();
    units.flattening = inverse == 0 ? 0 : 1 / inverse;
  } else {
    units.unit = crs.GetLinearUnits();
  }
  // Degrees come back as 1.0000000000000x from radians.
  if (units.geographic && std::abs(units.unit - 1) < 1e-12) units.unit = 1;
  return units;
}

}  // namespace

CrsUnits crs_units(const std::string& wkt) {
  if (wkt.empty()) return {};
  // Parsing takes a thousand times as long as the length of a cell, and the text seldom changes.
  thread_local std::string last_wkt;
  thread_local CrsUnits last;
  if (wkt != last_wkt) {
    last = parse(wkt);
    last_wkt = wkt;
  }
  return last;
}

}  // namespace dem::io

namespace dem {
namespace {

struct FreeText {
  void operator()(char* text) const { CPLFree(text); }
};

}  // namespace

std::string crs_wkt(const std::string& name) {
  if (name.empty()) return "";
  const io::GdalErrors quiet;
  OGRSpatialReference crs;
  const char* const only_names[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
  const bool number = name.find_first_not_of("0123456789") == name.npos;
  const std::string full = number ? "EPSG:" + name : name;
  const bool known = crs.SetFromUserInput(full.c_str(), only_names) == OGRERR_NONE;
  if (!known || (!crs.IsGeographic() && !crs.IsProjected()))
    throw std::invalid_argument(fmt::format(
        "crs = {}; must be a projected or geographic coordinate system, e.g. EPSG:32619",
        name.substr(0, 60)));
  char* text = nullptr;
  const OGRErr error = crs.exportToWkt(&text);
  const std::unique_ptr<char, FreeText> owner(text);
  if (error != OGRERR_NONE || !text)
    throw std::invalid_argument(fmt::format("crs = {}; has no description in WKT", name));
  return text;
}

}  // namespace dem
