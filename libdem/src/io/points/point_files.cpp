#include "dem/io/point_files.h"

#include <fmt/format.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "dem/io/rasters.h"
#include "io/crs.h"
#include "io/gdal_support.h"
#include "io/points/point_reading.h"
#include "io/staged_file.h"

namespace dem {
using namespace io;
namespace {

struct DestroyCrs {
  void operator()(void* crs) const { OSRDestroySpatialReference(crs); }
};
using CrsPtr = std::unique_ptr<void, DestroyCrs>;

struct DestroyTransformation {
  void operator()(OGRCoordinateTransformationH t) const { OCTDestroyCoordinateTransformation(t); }
};
using TransformationPtr =
    std::unique_ptr<std::remove_pointer_t<OGRCoordinateTransformationH>, DestroyTransformation>;

/// x is always east or longitude, y north or latitude.
CrsPtr parse_crs(const std::string& text) {
  const GdalErrors quiet;
  CrsPtr crs(OSRNewSpatialReference(nullptr));
  if (OSRSetFromUserInput(crs.get(), text.c_str()) != OGRERR_NONE)
    throw std::invalid_argument(fmt::format(
        "crs = {}; must be a coordinate system, e.g. EPSG:25832, PROJ or WKT", text.substr(0, 60)));
  OSRSetAxisMappingStrategy(crs.get(), OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

bool same_crs(const std::string& a, const std::string& b) {
  return a == b || OSRIsSame(parse_crs(a).get(), parse_crs(b).get()) != 0;
}

/// A latitude beyond 90 degrees: x and y are the wrong way round, or no degrees at all.
void check_degrees(const std::string& path, const Points& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points.x[i], y = points.y[i];
    if (std::abs(y) <= 90 && std::abs(x) <= 360) continue;
    if (std::abs(x) <= 90 && std::abs(y) <= 360)
      throw IoError(path,
                    fmt::format("x = {}, y = {}: y is no latitude; longitude and latitude are "
                                "the wrong way round",
                                x, y),
                    "x_field");
    throw IoError(path, fmt::format("x = {}, y = {} are no longitude and latitude", x, y), "crs");
  }
}

/// From the points' system to the one asked for.
class Bridge {
 public:
  Bridge(std::string path, std::string to) : path_(std::move(path)), to_(std::move(to)) {}

  /// Called with the first part, when the source's system is known.
  void open(PointSource& source) {
    opened_ = true;
    degrees_ = !source.crs_wkt.empty() && crs_units(source.crs_wkt).geographic;
    if (to_.empty()) return;
    if (source.crs_wkt.empty()) {
      source.notes.push_back("no coordinate system: taken as " + crs_name(to_));
    } else if (!same_crs(source.crs_wkt, to_)) {
      const GdalErrors errors;
      transformation_.reset(
          OCTNewCoordinateTransformation(parse_crs(source.crs_wkt).get(), parse_crs(to_).get()));
      if (!transformation_) errors.fail(path_, "cannot be brought to " + crs_name(to_));
      source.notes.push_back(fmt::format("from {} to {}", crs_name(source.crs_wkt), crs_name(to_)));
    }
    source.crs_wkt = to_;
  }
  bool opened() const { return opened_; }

  void cross(Points& points) const {
    if (degrees_) check_degrees(path_, points);
    if (!transformation_) return;
    const GdalErrors errors;
    std::vector<int> good(points.size(), 0);
    OCTTransformEx(transformation_.get(), int(points.size()), points.x.data(), points.y.data(),
                   nullptr, good.data());
    const auto bad = std::ranges::find(good, 0);
    if (bad != good.end())
      errors.fail(path_, fmt::format("a point cannot be brought to {}", crs_name(to_)));
  }

 private:
  std::string path_, to_;
  TransformationPtr transformation_;
  bool opened_ = false, degrees_ = false;
};

bool has_las_signature(const std::string& path) {
  const GdalErrors quiet;
  VSILFILE* file = VSIFOpenL(path.c_str(), "rb");
  if (file == nullptr) return false;
  std::array<char, 4> start{};
  const bool read = VSIFReadL(start.data(), 1, 4, file) == 4;
  VSIFCloseL(file);
  return read && std::string_view(start.data(), 4) == "LASF";
}

bool is_text_name(const std::string& path) {
  constexpr std::array names{".csv", ".txt", ".tsv", ".tab", ".xyz", ".dat", ".asc", ".pts"};
  std::string name = path;
  if (extension(name) == ".gz") name.resize(name.size() - 3);
  return path == "-" || path.starts_with("/vsistdin") ||
         std::ranges::find(names, extension(name)) != names.end();
}

}  // namespace

std::string io::wgs84() { return crs_from_text("EPSG:4326"); }

std::string crs_from_text(const std::string& text) {
  const CrsPtr crs = parse_crs(text);
  char* wkt = nullptr;
  OSRExportToWkt(crs.get(), &wkt);
  const std::unique_ptr<char, decltype(&VSIFree)> owned(wkt, VSIFree);
  return wkt == nullptr ? "" : wkt;
}

std::string crs_name(const std::string& crs_wkt) {
  if (crs_wkt.empty()) return "none";
  const char* name = OSRGetName(parse_crs(crs_wkt).get());
  return name == nullptr ? "unnamed" : name;
}

std::vector<Field> fields(PointReadOptions& o) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  return {
      {"x_field", o.x_field, "column or attribute of x, by name or by number from 1; \"\": found"},
      {"y_field", o.y_field, "column or attribute of y; \"\": found"},
      {"z_field", o.z_field, "column or attribute of the elevation in metres; \"\": found"},
      {"sigma_field", o.sigma_field, "column of the elevation's standard error in metres"},
      {"weight_field", o.weight_field, "column of the elevation's weight in a mean"},
      {"position_field", o.position_field, "column of whole positions in MGRS, UTM or DMS"},
      {"along_lines",
       o.along_lines,
       {0, infinite},
       "units of the file",
       "distance of the points that lines of a vector layer are read as; 0: their vertices"},
      {"layer", o.layer, "layer of a vector file; \"\": the only one"},
      {"nodata", o.nodata, {.or_nan = true}, "m", "an elevation that means none"},
      {"crs", o.crs, "coordinate system of x and y; \"\": as the file says"},
      {"to_crs", o.to_crs, "coordinate system that x and y are brought to; \"\": as they are"}};
}

namespace {

/// The options with the coordinate systems as WKT.
PointReadOptions with_systems(PointReadOptions options) {
  check_options(options);
  register_gdal();
  if (!options.crs.empty()) options.crs = crs_from_text(options.crs);
  if (!options.to_crs.empty()) options.to_crs = crs_from_text(options.to_crs);
  return options;
}

/// Hands points in memory on, in the coordinate system asked for.
PointSource deliver(const char* format, Points& points, std::size_t without_z,
                    const PointReadOptions& options, const PointSink& sink) {
  PointSource source;
  source.format = format;
  source.crs_wkt = options.crs;
  source.points = points.size();
  source.without_z = without_z;
  if (points.size() == 0)
    throw std::invalid_argument(
        fmt::format("{}: no point has a finite x, y and z; at least one is needed", format));
  try {
    Bridge bridge(format, options.to_crs);
    bridge.open(source);
    bridge.cross(points);
  } catch (const IoError& error) {  // there is no file whose fault this could be
    throw std::invalid_argument(error.what());
  }
  sink(points);
  return source;
}

/// Throws std::invalid_argument unless a column has a value for every point, or `may_be_empty`.
template <class T>
void check_length(const char* name, const std::vector<T>& column, std::size_t points,
                  bool may_be_empty) {
  if (column.size() != points && !(may_be_empty && column.empty()))
    throw std::invalid_argument(
        fmt::format("points.{} has {} values; must have {}, as z", name, column.size(), points));
}

/// Leaves out the points that have no position or no elevation, and returns their number.
std::size_t drop_unfinished(Points& points, const std::optional<double>& nodata) {
  const std::size_t n = points.size();
  check_length("x", points.x, n, false), check_length("y", points.y, n, false);
  check_length("sigma", points.sigma, n, true), check_length("weight", points.weight, n, true);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vertex v{points.x[i], points.y[i], double(points.z[i])};
    if (!v.finite() || nodata == v.z) continue;
    points.x[kept] = v.x, points.y[kept] = v.y, points.z[kept] = points.z[i];
    if (!points.sigma.empty()) points.sigma[kept] = points.sigma[i];
    if (!points.weight.empty()) points.weight[kept] = points.weight[i];
    ++kept;
  }
  points.x.resize(kept), points.y.resize(kept), points.z.resize(kept);
  if (!points.sigma.empty()) points.sigma.resize(kept);
  if (!points.weight.empty()) points.weight.resize(kept);
  return n - kept;
}

}  // namespace

PointSource deliver_points(Points points, const PointReadOptions& options, const PointSink& sink) {
  const PointReadOptions o = with_systems(options);
  const std::size_t without_z = drop_unfinished(points, o.nodata);
  return deliver("points", points, without_z, o, sink);
}

PointSource deliver_contours(const std::vector<ContourLine>& lines, const PointReadOptions& options,
                             const PointSink& sink) {
  const PointReadOptions o = with_systems(options);
  Points points;
  std::size_t without_z = 0;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const ContourLine& line = lines[l];
    if (line.x.size() != line.y.size())
      throw std::invalid_argument(
          fmt::format("contours: line {} has {} values of x and {} of y; must have as many", l,
                      line.x.size(), line.y.size()));
    Vertex last{};
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      const Vertex v{line.x[i], line.y[i], line.level_m};
      if (i > 0 && o.along_lines > 0 && last.finite() && v.finite())
        add_between(last, v, o.along_lines, points);
      add_point(v, without_z, points);
      last = v;
    }
  }
  return deliver("contours", points, without_z, o, sink);
}

PointSource read_points(const std::string& path, const PointReadOptions& options,
                        const PointSink& sink, const Run& run) {
  const PointReadOptions o = with_systems(options);
  PointSource source;
  Bridge bridge(path, o.to_crs);
  const auto parts = [&](Points& points) {
    if (points.size() == 0) return;
    if (!bridge.opened()) bridge.open(source);
    bridge.cross(points);
    source.points += points.size();
    sink(points);
  };
  if (extension(path) == ".laz")
    throw IoError(path, "is compressed LAS; uncompress it first (laszip -i in.laz -o out.las)");
  if (is_text_name(path))
    read_text_points(path, o, source, parts, run);
  else if (has_las_signature(path))
    read_las_points(path, o, source, parts, run);
  else
    read_vector_points(path, o, source, parts, run);
  if (source.points == 0)
    throw IoError(
        path, source.without_z > 0
                  ? fmt::format("no point has an elevation ({} rows)", source.without_z)
              : source.other_class > 0
                  ? fmt::format("none of its {} points is of a class asked for", source.other_class)
                  : std::string("holds no points"));
  return source;
}

}  // namespace dem
