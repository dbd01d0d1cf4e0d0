#include "dem/io/raster_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "io/gdal_support.h"
#include "io/raster/gdal_raster.h"
#include "io/raster/heightmap.h"
#include "io/raster/hgt.h"
#include "io/raster/nodata.h"
#include "io/raster/tile_folder.h"

namespace dem {
using namespace io;
namespace {

constexpr std::size_t cells_at_once = 1 << 22;

int rows_at_once(int cols) {
  return int(std::clamp<std::size_t>(cells_at_once / std::size_t(cols), 1, 256));
}

}  // namespace

void set_block_cache(std::size_t bytes) { GDALSetCacheMax64(GIntBig(bytes)); }

// ---- Reading

struct RasterReader::File {
  std::string path;
  ReadOptions options;
  OpenBand open;
  GeoRef ref;
  std::vector<double> sentinels;  // undeclared values that scan() found to mean unknown
  bool south_up = false;

  File(const std::string& name, const ReadOptions& read_options)
      : path(name), options(read_options), open(open_quietly(path, options)), ref(open.ref) {
    // Row 0 becomes the north when the file begins in the south.
    auto& at = ref.to_world;
    south_up = at[5] > 0 && at[2] == 0 && at[4] == 0;
    if (!south_up) return;
    at[3] += at[5] * (open.size.rows - 1);
    at[5] = -at[5];
  }

  static OpenBand open_quietly(const std::string& path, const ReadOptions& options) {
    GdalErrors errors;
    return open_band(path, options, errors);
  }

  NodataSearch search() const {
    return {open.declared_nodata, "declared value", options, std::abs(open.scale)};
  }

  /// The file's values of a box in rows as we count them; what says nothing becomes unknown.
  template <class T>
  void read_values(const Box& box, NodataSearch& search, Raster<T>& values, Mask& known) {
    const GdalErrors errors;
    const GDALDataType type = std::is_same_v<T, float> ? GDT_Float32 : GDT_Float64;
    const int top = south_up ? open.size.rows - box.row - box.rows : box.row;
    CPLErr error = GDALRasterIO(open.band, GF_Read, box.col, top, box.cols, box.rows,
                                values.cells().data(), box.cols, box.rows, type, 0, 0);
    if (open.mask && error == CE_None)
      error = GDALRasterIO(open.mask, GF_Read, box.col, top, box.cols, box.rows,
                           known.cells().data(), box.cols, box.rows, GDT_Byte, 0, 0);
    if (error != CE_None || errors.any()) errors.fail(path, "cells cannot be read");
    if (south_up)
      for (int a = 0, b = box.rows - 1; a < b; ++a, --b) {
        std::ranges::swap_ranges(values.row(a), values.row(b));
        std::ranges::swap_ranges(known.row(a), known.row(b));
      }
    for (int row = 0; row < box.rows; ++row) {
      const auto line = values.row(row);
      const auto flags = known.row(row);
      if (open.mask) {
        std::ranges::transform(flags, flags.begin(), [](auto m) { return std::uint8_t(m != 0); });
        search.count_masked(std::uint64_t(std::ranges::count(flags, 0)));
      }
      if (open.signed_byte)
        for (T& v : line) v = v > 127 ? v - 256 : v;
      search.scan_row(line, flags);
      for (const double sentinel : sentinels)
        for (std::size_t i = 0; i < line.size(); ++i)
          if (flags[i] && double(line[i]) == sentinel) {
            flags[i] = 0;
            line[i] = 0;
          }
    }
  }

  void read(const Box& box, NodataSearch& search, Dem& dem, Raster<double>* exact) {
    dem.z = Raster<float>(box.size());
    dem.known = Mask(box.size(), 1);
    if (open.floats_hold_it && !open.in_other_units())
      return read_values(box, search, dem.z, dem.known);
    Raster<double> values(box.size());
    read_values(box, search, values, dem.known);
    for (std::size_t i = 0; i < values.cells().size(); ++i) {
      double& v = values.cells()[i];
      if (open.in_other_units() && dem.known.cells()[i]) v = v * open.scale + open.offset;
      dem.z.cells()[i] = float(v);
    }
    if (exact && open.source.type != CellType::float32) *exact = std::move(values);
  }
};

RasterReader::RasterReader(const std::string& path, const ReadOptions& options) {
  check_options(options);
  const bool whole =
      is_hgt_name(path) || is_image_name(path) || options.heights || options.unknown_grey;
  if (whole && !is_list_of_files(path)) {
    whole_ = std::make_unique<DemFile>(read_dem(path, options));
    return;
  }
  file_ = std::make_unique<File>(path, options);
  Source& source = file_->open.source;
  if (file_->open.in_other_units() && source.type != CellType::float64)
    source.type = CellType::float32;
  source.nodata = file_->search().value();
}
RasterReader::~RasterReader() = default;

Size RasterReader::size() const { return whole_ ? whole_->dem.size() : file_->open.size; }
const GeoRef& RasterReader::ref() const { return whole_ ? whole_->dem.ref : file_->ref; }
const Source& RasterReader::source() const { return whole_ ? whole_->source : file_->open.source; }
std::size_t RasterReader::held_bytes() const { return whole_ ? 5 * whole_->dem.size().cells() : 0; }

void RasterReader::scan(
    const std::function<void()>& begin,
    const std::function<void(int, std::span<const std::uint8_t>, std::span<const float>)>& each,
    const Run& run) {
  const auto [cols, rows] = size();
  if (whole_) {
    begin();
    for (int row = 0; row < rows; ++row)
      each(row, whole_->dem.known.row(row), whole_->dem.z.row(row));
    return;
  }
  for (bool again = true; again;) {
    begin();
    NodataSearch search = file_->search();
    for (int row = 0; row < rows; row += rows_at_once(cols)) {
      run.report(double(row) / rows, "looking for holes");
      const Box box{0, row, cols, std::min(rows_at_once(cols), rows - row)};
      Dem part;
      file_->read(box, search, part, nullptr);
      for (int r = 0; r < box.rows; ++r) each(row + r, part.known.row(r), part.z.row(r));
    }
    again = false;
    if (file_->sentinels.empty()) {
      file_->sentinels = search.undeclared();
      again = !file_->sentinels.empty();
      file_->open.source.nodata = search.value();
      file_->open.source.evidence = search.evidence();
    }
  }
}

Dem RasterReader::read(const Box& box, Raster<double>* exact) {
  if (whole_) return crop(whole_->dem, box, {});
  Dem dem;
  NodataSearch search = file_->search();
  file_->read(box, search, dem, exact);
  dem.ref = crop(file_->ref, box);
  return dem;
}

}  // namespace dem
