#include "dem/io/polygons.h"

#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_alg.h>
#include <ogr_api.h>
#include <ogr_geometry.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "dem/io/rasters.h"
#include "io/gdal_support.h"
#include "io/staged_file.h"

namespace dem {
using namespace io;
namespace {

struct DestroyGeometry {
  void operator()(void* geometry) const { OGR_G_DestroyGeometry(geometry); }
};
using GeometryPtr = std::unique_ptr<void, DestroyGeometry>;

std::unique_ptr<OGRSpatialReference> crs_of(const GeoRef& ref) {
  auto crs = std::make_unique<OGRSpatialReference>();
  crs->importFromWkt(ref.crs_wkt.c_str());
  crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

/// World coordinates to columns and rows: (0, 0) is the corner of the first cell.
std::pair<double, double> to_cell(double x, double y, const std::array<double, 6>& inverse) {
  return {inverse[0] + inverse[1] * x + inverse[2] * y,
          inverse[3] + inverse[4] * x + inverse[5] * y};
}

void to_cells(OGRGeometryH geometry, const std::array<double, 6>& inverse) {
  for (int i = 0; i < OGR_G_GetGeometryCount(geometry); ++i)
    to_cells(OGR_G_GetGeometryRef(geometry, i), inverse);
  for (int i = 0; i < OGR_G_GetPointCount(geometry); ++i) {
    double x = 0, y = 0;
    OGR_G_GetPoint(geometry, i, &x, &y, nullptr);
    const auto [col, row] = to_cell(x, y, inverse);
    OGR_G_SetPoint_2D(geometry, i, col, row);
  }
}

/// From the corner of the first cell, in GDAL's order.
std::array<double, 6> corner_transform(const GeoRef& ref) {
  auto at = ref.to_world;
  at[0] -= 0.5 * (at[1] + at[2]);
  at[3] -= 0.5 * (at[4] + at[5]);
  return at;
}

/// What to_cell takes; nothing when the cells have no area.
std::optional<std::array<double, 6>> world_to_cells(const GeoRef& ref) {
  auto corner = corner_transform(ref);
  std::array<double, 6> inverse{};
  if (!GDALInvGeoTransform(corner.data(), inverse.data())) return {};
  return inverse;
}

/// Calls each(geometry) for every geometry of a vector file, in columns and rows of a raster.
template <class Each>
void for_each_geometry(const std::string& path, const GeoRef& ref, const Each& each) {
  GdalErrors errors;
  const DatasetPtr dataset(GDALOpenEx(path.c_str(),
                                      GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR,
                                      nullptr, nullptr, nullptr));
  if (!dataset) errors.fail(path, "cannot be opened");
  errors.clear();

  const auto inverse = world_to_cells(ref);
  if (!inverse) throw IoError(path, "the raster's cells have no area");
  const auto target = ref.crs_wkt.empty() ? nullptr : crs_of(ref);

  for (int l = 0; l < GDALDatasetGetLayerCount(dataset.get()); ++l) {
    const OGRLayerH layer = GDALDatasetGetLayer(dataset.get(), l);
    const OGRSpatialReferenceH own = OGR_L_GetSpatialRef(layer);
    if (target && !own)
      throw IoError(path, fmt::format("layer {} says no coordinate system; the raster has one",
                                      OGR_L_GetName(layer)));
    std::unique_ptr<OGRCoordinateTransformation> transform;
    if (target) {
      OGRSpatialReference from(*OGRSpatialReference::FromHandle(own));
      from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
      transform.reset(OGRCreateCoordinateTransformation(&from, target.get()));
      if (!transform) errors.fail(path, "its coordinates cannot be turned into the raster's");
    }
    OGR_L_ResetReading(layer);
    while (OGRFeatureH feature = OGR_L_GetNextFeature(layer)) {
      GeometryPtr geometry(OGR_F_StealGeometry(feature));
      OGR_F_Destroy(feature);
      if (!geometry) continue;
      if (transform &&
          OGRGeometry::FromHandle(geometry.get())->transform(transform.get()) != OGRERR_NONE)
        errors.fail(path, "its coordinates cannot be turned into the raster's");
      to_cells(geometry.get(), *inverse);
      each(std::move(geometry));
    }
  }
  if (errors.any()) errors.fail(path, "cannot be read");
}

/// Adds the lines of a geometry and of its parts.
void add_lines(OGRGeometryH geometry, std::vector<Breakline>& lines) {
  for (int i = 0; i < OGR_G_GetGeometryCount(geometry); ++i)
    add_lines(OGR_G_GetGeometryRef(geometry, i), lines);
  const int n = OGR_G_GetPointCount(geometry);
  if (n < 2) return;
  Breakline line;
  for (int i = 0; i < n; ++i) {  // from the corner of the first cell to its centre
    line.col.push_back(OGR_G_GetX(geometry, i) - 0.5);
    line.row.push_back(OGR_G_GetY(geometry, i) - 0.5);
  }
  lines.push_back(std::move(line));
}

}  // namespace

struct Polygons::Shapes {
  struct Shape {
    GeometryPtr geometry;
    OGREnvelope extent;
  };
  std::vector<Shape> all;
};

Polygons::Polygons(const std::string& path, const GeoRef& ref)
    : shapes_(std::make_unique<Shapes>()) {
  for_each_geometry(path, ref, [&](GeometryPtr geometry) {
    if (OGR_G_GetDimension(geometry.get()) != 2) return;
    Shapes::Shape shape{std::move(geometry), {}};
    OGR_G_GetEnvelope(shape.geometry.get(), &shape.extent);
    shapes_->all.push_back(std::move(shape));
  });
  if (shapes_->all.empty()) throw IoError(path, "holds no polygon");
}

Breaklines read_breaklines(const std::string& path, const GeoRef& ref, Size size) {
  std::vector<Breakline> lines;
  for_each_geometry(path, ref, [&](const GeometryPtr& geometry) {
    const GeometryPtr straight(OGR_G_GetLinearGeometry(geometry.get(), 0, nullptr));
    add_lines(straight.get(), lines);
  });
  if (lines.empty()) throw IoError(path, "holds no line and no polygon");
  return {lines, size};
}

Breaklines make_breaklines(const std::vector<WorldLine>& lines, const std::string& crs_wkt,
                           const GeoRef& ref, Size size) {
  std::unique_ptr<OGRCoordinateTransformation> transform;
  if (!crs_wkt.empty() && !ref.crs_wkt.empty()) {
    const GdalErrors quiet;
    const auto from = crs_of({{}, crs_wkt}), to = crs_of(ref);
    transform.reset(OGRCreateCoordinateTransformation(from.get(), to.get()));
    if (!transform)
      throw std::invalid_argument("breaklines: cannot be turned into the raster's coordinates");
  }
  const auto inverse = world_to_cells(ref);
  if (!inverse) throw std::invalid_argument("breaklines: the raster's cells have no area");
  std::vector<Breakline> in_cells;
  for (WorldLine line : lines) {
    if (line.x.size() != line.y.size() || line.x.size() < 2)
      throw std::invalid_argument(
          fmt::format("breaklines: line {} has {} values of x and {} of y; must have as many, at "
                      "least 2",
                      in_cells.size(), line.x.size(), line.y.size()));
    const GdalErrors quiet;
    if (transform && !transform->Transform(int(line.x.size()), line.x.data(), line.y.data()))
      throw std::invalid_argument(fmt::format(
          "breaklines: line {} cannot be turned into the raster's coordinates", in_cells.size()));
    Breakline cells;
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      const auto [col, row] = to_cell(line.x[i], line.y[i], *inverse);
      cells.col.push_back(col - 0.5);
      cells.row.push_back(row - 0.5);
    }
    in_cells.push_back(std::move(cells));
  }
  return {in_cells, size};
}

Polygons::~Polygons() = default;
Polygons::Polygons(Polygons&&) noexcept = default;
Polygons& Polygons::operator=(Polygons&&) noexcept = default;

Mask Polygons::cells_in(const Box& box) const {
  Mask mask(box.size());
  std::vector<OGRGeometryH> near;
  for (const auto& shape : shapes_->all)
    if (shape.extent.MaxX >= box.col && shape.extent.MinX <= box.col + box.cols &&
        shape.extent.MaxY >= box.row && shape.extent.MinY <= box.row + box.rows)
      near.push_back(shape.geometry.get());
  if (near.empty()) return mask;

  const GdalErrors errors;
  const DatasetPtr dataset = wrap_cells(mask.cells().data(), box.cols, box.rows, GDT_Byte);
  double transform[6] = {double(box.col), 1, 0, double(box.row), 0, 1};
  GDALSetGeoTransform(dataset.get(), transform);
  int band = 1;
  const std::vector<double> ones(near.size(), 1);
  const CPLErr error =
      GDALRasterizeGeometries(dataset.get(), 1, &band, int(near.size()), near.data(), nullptr,
                              nullptr, ones.data(), nullptr, nullptr, nullptr);
  if (error != CE_None) errors.fail("polygons", "cannot be drawn on the raster");
  return mask;
}

namespace {

/// The outline of a hole, in world coordinates.
GeometryPtr outline(const std::vector<CellRun>& runs, const Box& box, const GeoRef& ref) {
  Mask inside(box.size());
  for (const CellRun& run : runs)
    std::fill_n(inside.row(run.row - box.row).begin() + (run.begin - box.col), run.end - run.begin,
                std::uint8_t{1});
  const DatasetPtr raster = wrap_cells(inside.cells().data(), box.cols, box.rows, GDT_Byte);
  auto corner = corner_transform(ref);
  corner[0] += corner[1] * box.col + corner[2] * box.row;
  corner[3] += corner[4] * box.col + corner[5] * box.row;
  GDALSetGeoTransform(raster.get(), corner.data());
  const GDALRasterBandH band = GDALGetRasterBand(raster.get(), 1);

  const DatasetPtr memory(
      GDALCreate(GDALGetDriverByName("Memory"), "", 0, 0, 0, GDT_Unknown, nullptr));
  const OGRLayerH parts =
      GDALDatasetCreateLayer(memory.get(), "outline", nullptr, wkbPolygon, nullptr);
  GDALPolygonize(band, band, parts, -1, nullptr, nullptr, nullptr);
  GeometryPtr all(OGR_G_CreateGeometry(wkbMultiPolygon));
  OGR_L_ResetReading(parts);
  while (OGRFeatureH feature = OGR_L_GetNextFeature(parts)) {
    if (OGRGeometryH part = OGR_F_StealGeometry(feature))
      OGR_G_AddGeometryDirectly(all.get(), part);
    OGR_F_Destroy(feature);
  }
  return all;
}

std::string vector_format_of(const std::string& path) {
  register_gdal();
  const std::string ext = extension(path);
  for (int i = 0; !ext.empty() && i < GDALGetDriverCount(); ++i) {
    const GDALDriverH driver = GDALGetDriver(i);
    const auto item = [&](const char* key) {
      const char* text = GDALGetMetadataItem(driver, key, nullptr);
      return std::string(text ? text : "");
    };
    if (item(GDAL_DCAP_VECTOR) != "YES" || item(GDAL_DCAP_CREATE) != "YES") continue;
    const CPLStringList extensions(CSLTokenizeString(item(GDAL_DMD_EXTENSIONS).c_str()));
    if (extensions.FindString(ext.c_str() + 1) >= 0) return GDALGetDriverShortName(driver);
  }
  throw IoError(path, "its extension names no vector format that can be written, such as .gpkg");
}

}  // namespace

void write_holes(const std::string& path, const std::vector<Hole>& holes, const Mask& known,
                 const GeoRef& ref, bool overwrite) {
  const std::string format = vector_format_of(path);
  GdalErrors errors;
  StagedFile staged(path, overwrite);
  {
    DatasetPtr dataset(GDALCreate(GDALGetDriverByName(format.c_str()), staged.path().c_str(), 0, 0,
                                  0, GDT_Unknown, nullptr));
    const auto crs = ref.crs_wkt.empty() ? nullptr : crs_of(ref);
    const OGRLayerH layer =
        dataset ? GDALDatasetCreateLayer(dataset.get(), "holes",
                                         crs ? OGRSpatialReference::ToHandle(crs.get()) : nullptr,
                                         wkbMultiPolygon, nullptr)
                : nullptr;
    if (!layer) errors.fail(path, "cannot be written");
    for (const HoleFact& fact : hole_facts()) {
      const OGRFieldDefnH field = OGR_Fld_Create(fact.name.c_str(), OFTReal);
      OGR_L_CreateField(layer, field, TRUE);
      OGR_Fld_Destroy(field);
    }

    std::vector<FirstCell> first;
    for (const Hole& hole : holes) first.push_back({hole.first_col, hole.box.row});
    const auto cells = cells_of_holes(known, first);
    GDALDatasetStartTransaction(dataset.get(), FALSE);
    errors.clear();  // a format without transactions says so, and needs none
    for (std::size_t h = 0; h < holes.size(); ++h) {
      const OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
      int field = 0;
      for (const HoleFact& fact : hole_facts())
        OGR_F_SetFieldDouble(feature, field++, fact.value(holes[h]));
      OGR_F_SetGeometryDirectly(feature, outline(cells[h], holes[h].box, ref).release());
      const OGRErr error = OGR_L_CreateFeature(layer, feature);
      OGR_F_Destroy(feature);
      if (error != OGRERR_NONE || errors.any()) errors.fail(path, "cannot be written");
    }
    GDALDatasetCommitTransaction(dataset.get());
  }
  if (errors.any()) errors.fail(path, "cannot be written");
  staged.commit();
}

}  // namespace dem
