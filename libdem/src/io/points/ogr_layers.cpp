#include "io/points/ogr_layers.h"

#include <fmt/format.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "dem/io/rasters.h"

namespace dem::io {
namespace {

std::vector<std::string> layer_names(GDALDatasetH dataset) {
  std::vector<std::string> names;
  for (int i = 0; i < GDALDatasetGetLayerCount(dataset); ++i)
    names.emplace_back(OGR_L_GetName(GDALDatasetGetLayer(dataset, i)));
  return names;
}

bool is_number(OGRFieldDefnH field) {
  const OGRFieldType type = OGR_Fld_GetType(field);
  return type == OFTInteger || type == OFTInteger64 || type == OFTReal;
}

}  // namespace

bool is_elevation_name(const std::string& name) {
  constexpr std::array names{"z",        "elev",     "elevation",  "height",  "alt",     "altitude",
                             "ele",      "hgt",      "h",          "dem",     "contour", "elev_m",
                             "z_m",      "level",    "hoehe",      "altitud", "quota",   "cota",
                             "elevatio", "height_m", "elevation_m"};
  std::string lower = name;
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return char(std::tolower(c)); });
  return std::ranges::find(names, lower) != names.end();
}

VectorLayer::VectorLayer(const std::string& path, const std::string& name) : path_(path) {
  const GdalErrors errors;
  dataset_.reset(GDALOpenEx(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                            nullptr, nullptr, nullptr));
  if (!dataset_ && GDALIdentifyDriverEx(path.c_str(), GDAL_OF_RASTER, nullptr, nullptr))
    throw IoError(path, "is a raster; points are text with columns, LAS or a vector layer");
  if (!dataset_) errors.fail(path, "no format of points is known that it has");
  const auto names = layer_names(dataset_.get());
  if (names.empty()) throw IoError(path, "has no layer");
  if (name.empty() && names.size() > 1)
    throw IoError(
        path,
        fmt::format("has {} layers; one must be chosen: {}", names.size(), fmt::join(names, ", ")),
        "layer");
  layer_ = name.empty() ? GDALDatasetGetLayer(dataset_.get(), 0)
                        : GDALDatasetGetLayerByName(dataset_.get(), name.c_str());
  if (layer_ == nullptr)
    throw IoError(path,
                  fmt::format("has no layer {}; there are: {}", name, fmt::join(names, ", ")));
}

std::string VectorLayer::driver() const {
  return GDALGetDriverShortName(GDALGetDatasetDriver(dataset_.get()));
}

std::string VectorLayer::crs_wkt() const {
  OGRSpatialReferenceH crs = OGR_L_GetSpatialRef(layer_);
  if (crs == nullptr) return "";
  char* wkt = nullptr;
  OSRExportToWkt(crs, &wkt);
  const std::unique_ptr<char, decltype(&VSIFree)> owned(wkt, VSIFree);
  return wkt == nullptr ? "" : wkt;
}

int VectorLayer::number_field(const std::string& option, const std::string& name) const {
  OGRFeatureDefnH fields = OGR_L_GetLayerDefn(layer_);
  const int i = OGR_FD_GetFieldIndex(fields, name.c_str());
  if (i >= 0 && is_number(OGR_FD_GetFieldDefn(fields, i))) return i;
  std::vector<std::string> numbers;
  for (int k = 0; k < OGR_FD_GetFieldCount(fields); ++k)
    if (is_number(OGR_FD_GetFieldDefn(fields, k))) numbers.push_back(field_name(k));
  throw IoError(
      path_, fmt::format("{} = {}: {}; its number fields: {}", option, name,
                         i < 0 ? "no such field" : "is no number field",
                         numbers.empty() ? "none" : fmt::format("{}", fmt::join(numbers, ", "))));
}

int VectorLayer::elevation_field(const std::string& name) const {
  if (!name.empty()) return number_field("z-field", name);
  OGRFeatureDefnH fields = OGR_L_GetLayerDefn(layer_);
  std::vector<std::string> numbers;
  for (int k = 0; k < OGR_FD_GetFieldCount(fields); ++k) {
    if (!is_number(OGR_FD_GetFieldDefn(fields, k))) continue;
    numbers.push_back(field_name(k));
    if (is_elevation_name(numbers.back())) return k;
  }
  bool has_z = false, any = false;
  for_each([&](OGRFeatureH feature) {
    if (OGRGeometryH g = OGR_F_GetGeometryRef(feature)) any = true, has_z = OGR_G_Is3D(g) != 0;
    return !any;
  });
  if (has_z || !any) return -1;
  throw IoError(
      path_,
      fmt::format("layer {} has no elevations: its geometry has no z, and no field "
                  "is called so ({})",
                  OGR_L_GetName(layer_),
                  numbers.empty() ? "it has no number field"
                                  : fmt::format("number fields: {}", fmt::join(numbers, ", "))),
      "z_field");
}

std::string VectorLayer::field_name(int field) const {
  return OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(OGR_L_GetLayerDefn(layer_), field));
}

void VectorLayer::for_each(const std::function<bool(OGRFeatureH)>& each) const {
  const GdalErrors errors;
  OGR_L_ResetReading(layer_);
  while (OGRFeatureH feature = OGR_L_GetNextFeature(layer_)) {
    const std::unique_ptr<void, decltype(&OGR_F_Destroy)> owned(feature, OGR_F_Destroy);
    if (!each(feature)) break;
  }
  if (errors.any()) errors.fail(path_, "cannot be read");
}

}  // namespace dem::io
