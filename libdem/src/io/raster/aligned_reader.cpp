#include <fmt/format.h>
#include <gdalwarper.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "dem/io/raster_stream.h"
#include "io/gdal_support.h"
#include "io/raster/gdal_raster.h"

namespace dem {
using namespace io;
namespace {

constexpr float nothing = -3e38f;  // "no height" for the warper

std::unique_ptr<OGRSpatialReference> crs_of(const GeoRef& ref) {
  auto crs = std::make_unique<OGRSpatialReference>();
  crs->importFromWkt(ref.crs_wkt.c_str());
  crs->StripVertical();  // a datum shift is the delta surface's to remove
  crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

/// Horizontal coordinates only.
GeoRef flat(GeoRef ref) {
  if (ref.crs_wkt.empty()) return ref;
  const auto crs = crs_of(ref);
  char* text = nullptr;
  crs->exportToWkt(&text);
  ref.crs_wkt = text ? text : "";
  CPLFree(text);
  return ref;
}

/// Also at the origin with cells of 1, which set_georeference takes for no place at all.
void place(GDALDatasetH dataset, const GeoRef& ref) {
  set_georeference(dataset, ref);
  auto corner = ref.to_world;
  corner[0] -= 0.5 * (corner[1] + corner[2]);
  corner[3] -= 0.5 * (corner[4] + corner[5]);
  GDALSetGeoTransform(dataset, corner.data());
}

}  // namespace

struct AlignedReader::File {
  std::string path;
  GeoRef target, ref;
  Size size;
  std::unique_ptr<RasterReader> reader;
  std::unique_ptr<OGRCoordinateTransformation> to_own;  // null: the same coordinates

  /// The part of the file around the cells of a box of the target; none when they do not meet.
  std::optional<Box> own_box(const Box& box) const {
    const auto& from = target.to_world;
    auto corner = ref.to_world;
    std::array<double, 6> inverse{};
    if (!GDALInvGeoTransform(corner.data(), inverse.data())) return std::nullopt;
    double low_col = 1e300, high_col = -1e300, low_row = 1e300, high_row = -1e300;
    constexpr int steps = 16;  // points along each side: lines of one grid bend in the other
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= steps; ++j) {
        const double col = box.col + double(box.cols) * i / steps;
        const double row = box.row + double(box.rows) * j / steps;
        double x = from[0] + from[1] * col + from[2] * row;
        double y = from[3] + from[4] * col + from[5] * row;
        if (to_own && !to_own->Transform(1, &x, &y)) continue;
        const double c = inverse[0] + inverse[1] * x + inverse[2] * y;
        const double r = inverse[3] + inverse[4] * x + inverse[5] * y;
        low_col = std::min(low_col, c), high_col = std::max(high_col, c);
        low_row = std::min(low_row, r), high_row = std::max(high_row, r);
      }
    constexpr double reach = 6;  // of the cubic kernel, and for what bends between the points
    const auto cell = [](double v, int most) { return int(std::clamp(v, 0., double(most))); };
    const int left = cell(low_col - reach, size.cols), right = cell(high_col + reach, size.cols);
    const int top = cell(low_row - reach, size.rows), bottom = cell(high_row + reach, size.rows);
    if (left >= right || top >= bottom) return std::nullopt;
    return Box{left, top, right - left, bottom - top};
  }
};

AlignedReader::AlignedReader(const std::string& path, const GeoRef& target)
    : file_(std::make_unique<File>()) {
  File& f = *file_;
  f.path = path;
  f.target = flat(target);
  f.reader = std::make_unique<RasterReader>(path, ReadOptions{});
  f.ref = f.reader->ref();
  f.size = f.reader->size();
  f.ref = flat(f.ref);
  if (f.ref.crs_wkt.empty() != f.target.crs_wkt.empty())
    throw IoError(path, f.ref.crs_wkt.empty()
                            ? "says no coordinate system; the raster to fill has one"
                            : "has a coordinate system; the raster to fill says none");
  if (f.ref.crs_wkt.empty()) return;
  const auto from = crs_of(f.target), to = crs_of(f.ref);
  if (from->IsSame(to.get())) return;
  f.to_own.reset(OGRCreateCoordinateTransformation(from.get(), to.get()));
  if (!f.to_own) throw IoError(path, "its coordinates cannot be turned into the raster's");
}
AlignedReader::~AlignedReader() = default;
AlignedReader::AlignedReader(AlignedReader&&) noexcept = default;
AlignedReader& AlignedReader::operator=(AlignedReader&&) noexcept = default;

Dem AlignedReader::read(const Box& box) {
  File& f = *file_;
  Dem out{Raster<float>(box.size(), nothing), Mask(box.size()), crop(f.target, box), {}};
  if (const auto own = f.own_box(box)) {
    Dem part = f.reader->read(*own);
    for (std::size_t i = 0; i < part.z.cells().size(); ++i)
      if (!part.known.cells()[i]) part.z.cells()[i] = nothing;
    const GdalErrors errors;
    const DatasetPtr from = wrap_cells(part.z.cells().data(), own->cols, own->rows, GDT_Float32);
    const DatasetPtr to = wrap_cells(out.z.cells().data(), box.cols, box.rows, GDT_Float32);
    place(from.get(), crop(f.ref, *own));
    place(to.get(), out.ref);
    for (const auto& dataset : {from.get(), to.get()})
      GDALSetRasterNoDataValue(GDALGetRasterBand(dataset, 1), double(nothing));
    if (GDALReprojectImage(from.get(), nullptr, to.get(), nullptr, GRA_Cubic, 0, 0.05, nullptr,
                           nullptr, nullptr) != CE_None)
      errors.fail(f.path, "cannot be brought onto the raster");
  }
  for (std::size_t i = 0; i < out.z.cells().size(); ++i) {
    float& z = out.z.cells()[i];
    out.known.cells()[i] = z > -1e30f;
    if (!out.known.cells()[i]) z = 0;
  }
  return out;
}

}  // namespace dem
