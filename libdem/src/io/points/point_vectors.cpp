// Points of the vector formats that GDAL opens.

#include <fmt/format.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "dem/io/rasters.h"
#include "io/gdal_support.h"
#include "io/points/ogr_layers.h"
#include "io/points/point_reading.h"

namespace dem::io {

bool Vertex::finite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(z); }

void add_point(const Vertex& v, std::size_t& without_z, Points& points) {
  if (!v.finite()) {
    ++without_z;
    return;
  }
  points.x.push_back(v.x);
  points.y.push_back(v.y);
  points.z.push_back(float(v.z));
}

void add_between(const Vertex& a, const Vertex& b, double spacing, Points& points) {
  const double steps = std::ceil(std::hypot(b.x - a.x, b.y - a.y) / spacing);
  for (double i = 1; i < steps; ++i) {
    const double t = i / steps;
    points.x.push_back(a.x + t * (b.x - a.x));
    points.y.push_back(a.y + t * (b.y - a.y));
    points.z.push_back(float(a.z + t * (b.z - a.z)));
  }
}

namespace {

/// How the vertices of a feature become points.
struct Taking {
  double height;       // of all vertices; NaN: none
  bool height_is_set;  // else each vertex has its own
  double spacing;      // along lines; 0: vertices only
};

/// All vertices of a geometry, of its parts too.
void add_vertices(OGRGeometryH geometry, const Taking& how, std::size_t& without_z,
                  Points& points) {
  for (int i = 0; i < OGR_G_GetGeometryCount(geometry); ++i)
    add_vertices(OGR_G_GetGeometryRef(geometry, i), how, without_z, points);
  const OGRwkbGeometryType type = OGR_GT_Flatten(OGR_G_GetGeometryType(geometry));
  if (type != wkbPoint && type != wkbLineString) return;
  Vertex last{};
  for (int i = 0; i < OGR_G_GetPointCount(geometry); ++i) {
    Vertex v{};
    OGR_G_GetPoint(geometry, i, &v.x, &v.y, &v.z);
    if (how.height_is_set) v.z = how.height;
    if (i > 0 && how.spacing > 0 && last.finite() && v.finite())
      add_between(last, v, how.spacing, points);
    add_point(v, without_z, points);
    last = v;
  }
}

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

double number_in(OGRFeatureH feature, int field) {
  return OGR_F_IsFieldSetAndNotNull(feature, field) ? OGR_F_GetFieldAsDouble(feature, field)
                                                    : no_number;
}

}  // namespace

void read_vector_points(const std::string& path, const PointReadOptions& options,
                        PointSource& source, const PointParts& parts, const Run& run) {
  if (!options.x_field.empty() || !options.y_field.empty() || !options.position_field.empty())
    throw IoError(path,
                  "is a vector file, whose geometry has the positions; x_field, y_field "
                  "and position_field are for text");
  const VectorLayer layer(path, options.layer);
  source.format = layer.driver();
  source.crs_wkt = options.crs.empty() ? layer.crs_wkt() : options.crs;
  const int z_field = layer.elevation_field(options.z_field);
  const int sigma_field =
      options.sigma_field.empty() ? -1 : layer.number_field("sigma-field", options.sigma_field);
  const int weight_field =
      options.weight_field.empty() ? -1 : layer.number_field("weight-field", options.weight_field);
  source.notes.push_back(z_field < 0 ? "elevations: z of the geometry"
                                     : "elevations: field " + layer.field_name(z_field));

  constexpr std::size_t at_a_time = 1 << 17;
  const double all = double(std::max<GIntBig>(1, OGR_L_GetFeatureCount(layer.get(), FALSE)));
  Points points;
  std::size_t features = 0;
  layer.for_each([&](OGRFeatureH feature) {
    if (++features % 4096 == 0) run.report(std::min(1., double(features) / all), "reading points");
    OGRGeometryH geometry = OGR_F_GetGeometryRef(feature);
    if (geometry == nullptr) {
      ++source.without_z;
      return true;
    }
    double height = z_field < 0 ? 0 : number_in(feature, z_field);
    if (options.nodata == height && z_field >= 0) height = no_number;
    add_vertices(geometry, {height, z_field >= 0, options.along_lines}, source.without_z, points);
    if (sigma_field >= 0)
      points.sigma.resize(points.size(), float(number_in(feature, sigma_field)));
    if (weight_field >= 0)
      points.weight.resize(points.size(), float(number_in(feature, weight_field)));
    if (points.size() >= at_a_time) {
      parts(points);
      points = {};
    }
    return true;
  });
  parts(points);
}

}  // namespace dem::io
