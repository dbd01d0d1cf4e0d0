#include "dem/io/drawing.h"

#include <fmt/format.h>
#include <gdal_alg.h>
#include <ogr_api.h>

#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "dem/io/rasters.h"
#include "io/gdal_support.h"
#include "io/images/image_module.h"
#include "io/points/ogr_layers.h"

namespace dem {
using namespace io;
namespace {

const std::map<std::string, double> greys{
    {"ridge", 0.75}, {"river", 0.25}, {"land", 1}, {"rocks", 0.5}, {"sea", 0}};

DatasetPtr open(const std::string& path, unsigned kind) {
  register_gdal();
  const GdalErrors quiet;
  return DatasetPtr(GDALOpenEx(path.c_str(), kind | GDAL_OF_READONLY, nullptr, nullptr, nullptr));
}

/// The grey of a feature, by its fields.
double grey_of(const std::string& path, OGRFeatureH feature, int grey_field, int kind_field) {
  if (grey_field >= 0 && OGR_F_IsFieldSetAndNotNull(feature, grey_field)) {
    const double grey = OGR_F_GetFieldAsDouble(feature, grey_field);
    if (!(grey >= 0 && grey <= 1))
      throw IoError(path, fmt::format("feature {} has grey = {}; must be in [0, 1]",
                                      OGR_F_GetFID(feature), grey));
    return grey;
  }
  const std::string kind = kind_field >= 0 ? OGR_F_GetFieldAsString(feature, kind_field) : "";
  const auto found = greys.find(kind);
  if (found == greys.end())
    throw IoError(path,
                  fmt::format("feature {} has kind = \"{}\"; must be ridge, river, land, rocks or "
                              "sea, or have a field grey",
                              OGR_F_GetFID(feature), kind));
  return found->second;
}

/// A number field of a feature; none when it is not set.
std::optional<double> number_of(OGRFeatureH feature, const char* name) {
  const int field = OGR_F_GetFieldIndex(feature, name);
  if (field < 0 || !OGR_F_IsFieldSetAndNotNull(feature, field)) return {};
  return OGR_F_GetFieldAsDouble(feature, field);
}

/// The points of a line, in cells.
std::vector<RidgePoint> points_of(OGRGeometryH line, const Canvas& canvas, double height_m,
                                  double width_m) {
  const auto& w = canvas.ref.to_world;
  std::vector<RidgePoint> points;
  for (int i = 0; i < OGR_G_GetPointCount(line); ++i)
    points.push_back({(OGR_G_GetX(line, i) - w[0]) / w[1], (OGR_G_GetY(line, i) - w[3]) / w[5],
                      height_m, width_m});
  return points;
}

/// Adds the lines of a feature when it is a ridge with a height and a width.
void add_ridges(const std::string& path, OGRFeatureH feature, const Canvas& canvas,
                std::vector<std::vector<RidgePoint>>& ridges) {
  const int kind = OGR_F_GetFieldIndex(feature, "kind");
  if (kind < 0 || std::string_view(OGR_F_GetFieldAsString(feature, kind)) != "ridge") return;
  const auto height = number_of(feature, "height_m"), width = number_of(feature, "width_m");
  if (!height && !width) return;
  if (!height || !width || !(*height > 0) || !(*width > 0))
    throw IoError(path, fmt::format("ridge {}: height_m = {}, width_m = {}; must both be above 0",
                                    OGR_F_GetFID(feature), height.value_or(0), width.value_or(0)));
  const OGRGeometryH geometry = OGR_F_GetGeometryRef(feature);
  const int parts = OGR_G_GetGeometryCount(geometry);  // 0 for a single line
  if (parts == 0) ridges.push_back(points_of(geometry, canvas, *height, *width));
  for (int i = 0; i < parts; ++i)
    ridges.push_back(points_of(OGR_G_GetGeometryRef(geometry, i), canvas, *height, *width));
}

struct Shapes {
  std::vector<OGRGeometryH> geometries;
  std::vector<double> greys;
  std::vector<std::vector<RidgePoint>> ridges;
  bool polygons = false;

  Shapes() = default;
  Shapes(const Shapes&) = delete;
  Shapes& operator=(const Shapes&) = delete;
  ~Shapes() {
    for (OGRGeometryH geometry : geometries) OGR_G_DestroyGeometry(geometry);
  }
};

void read_shapes(const std::string& path, const Canvas& canvas, Shapes& shapes) {
  const VectorLayer layer(path, "");
  const OGRFeatureDefnH fields = OGR_L_GetLayerDefn(layer.get());
  const int grey = OGR_FD_GetFieldIndex(fields, "grey"),
            kind = OGR_FD_GetFieldIndex(fields, "kind");
  layer.for_each([&](OGRFeatureH feature) {
    const OGRGeometryH geometry = OGR_F_GetGeometryRef(feature);
    if (!geometry) return true;
    const int dimension = OGR_G_GetDimension(geometry);
    if (dimension < 1)
      throw IoError(path, fmt::format("feature {} is a point; must be a line or a polygon",
                                      OGR_F_GetFID(feature)));
    shapes.greys.push_back(grey_of(path, feature, grey, kind));
    shapes.geometries.push_back(OGR_G_Clone(geometry));
    shapes.polygons |= dimension == 2;
    if (dimension == 1) add_ridges(path, feature, canvas, shapes.ridges);
    return true;
  });
  if (shapes.geometries.empty()) throw IoError(path, "holds no line and no polygon");
}

}  // namespace

bool is_vector_file(const std::string& path) {
  return !open(path, GDAL_OF_RASTER) && open(path, GDAL_OF_VECTOR);
}

Drawing draw_vectors(const std::string& path, const Canvas& canvas) {
  Shapes shapes;
  read_shapes(path, canvas, shapes);
  Raster<float> drawing(canvas.size, shapes.polygons ? 0.0F : 1.0F);
  const GdalErrors errors;
  const DatasetPtr dataset =
      wrap_cells(drawing.cells().data(), drawing.cols(), drawing.rows(), GDT_Float32);
  std::array<double, 6> corner = canvas.ref.to_world;
  corner[0] -= 0.5 * (corner[1] + corner[2]);
  corner[3] -= 0.5 * (corner[4] + corner[5]);
  GDALSetGeoTransform(dataset.get(), corner.data());
  int band = 1;
  const CPLErr error = GDALRasterizeGeometries(
      dataset.get(), 1, &band, int(shapes.geometries.size()), shapes.geometries.data(), nullptr,
      nullptr, shapes.greys.data(), nullptr, nullptr, nullptr);
  if (error != CE_None) errors.fail(path, "cannot be drawn on the canvas");
  return {std::move(drawing), std::move(shapes.ridges)};
}

Raster<float> median_filter(const Raster<float>& z, int side, int passes, const Run& run) {
  if (side < 1 || side > 255 || side % 2 == 0)
    throw std::invalid_argument(fmt::format("side = {}; must be an odd number in [1, 255]", side));
  if (passes < 0 || passes > 100)
    throw std::invalid_argument(fmt::format("passes = {}; must be in [0, 100]", passes));
  Raster<float> from = z, to(z.size());
  if (z.empty()) return from;
  for (int pass = 0; pass < passes; ++pass) {
    run.report(double(pass) / passes, "median");
    image_module().median_filter(from.cells().data(), to.cells().data(), z.cols(), z.rows(), side,
                                 run.threads);
    std::swap(from, to);
  }
  return from;
}

}  // namespace dem
