#include "dem/raster_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "cells.h"
#include "gdal_raster.h"
#include "gdal_support.h"
#include "nodata.h"
#include "staged_file.h"

namespace dem {
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

RasterReader::RasterReader(const std::string& path, const ReadOptions& options)
    : file_(std::make_unique<File>(path, options)) {
  Source& source = file_->open.source;
  if (file_->open.in_other_units() && source.type != CellType::float64)
    source.type = CellType::float32;
  source.nodata = file_->search().value();
}
RasterReader::~RasterReader() = default;

Size RasterReader::size() const { return file_->open.size; }
const GeoRef& RasterReader::ref() const { return file_->ref; }
const Source& RasterReader::source() const { return file_->open.source; }

void RasterReader::scan(
    const std::function<void()>& begin,
    const std::function<void(int, std::span<const std::uint8_t>, std::span<const float>)>& each,
    const Run& run) {
  const auto [cols, rows] = size();
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
  Dem dem;
  NodataSearch search = file_->search();
  file_->read(box, search, dem, exact);
  dem.ref = file_->ref;
  auto& at = dem.ref.to_world;
  at[0] += at[1] * box.col + at[2] * box.row;
  at[3] += at[4] * box.col + at[5] * box.row;
  return dem;
}

// ---- Writing

namespace {

/// The value that will mean unknown, chosen before the cells are seen.
template <class T>
std::optional<T> choose_nodata(const std::string& path, const Source& source,
                               const WriteOptions& options) {
  const auto fits = [](double v) {
    if constexpr (std::is_floating_point_v<T>) return true;
    return v == std::trunc(v) && v >= double(std::numeric_limits<T>::min()) &&
           v <= double(std::numeric_limits<T>::max());
  };
  if (options.nodata) {
    if (!fits(*options.nodata))
      throw IoError(path,
                    fmt::format("no-data {} does not fit the type, {} to {}", *options.nodata,
                                std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max()));
    return T(*options.nodata);
  }
  if (source.nodata && fits(*source.nodata)) return T(*source.nodata);
  if constexpr (sizeof(T) == 1) return std::nullopt;
  if (std::is_unsigned_v<T>) return std::numeric_limits<T>::max();
  return T(std::is_same_v<T, std::int16_t> ? -32768 : -9999);
}

template <class Call>
auto with_type(CellType type, const Call& call) {
  switch (type) {
    case CellType::int8:
      return call(std::int8_t{});
    case CellType::uint8:
      return call(std::uint8_t{});
    case CellType::int16:
      return call(std::int16_t{});
    case CellType::uint16:
      return call(std::uint16_t{});
    case CellType::int32:
      return call(std::int32_t{});
    case CellType::uint32:
      return call(std::uint32_t{});
    case CellType::float32:
      return call(float{});
    case CellType::float64:
      break;
  }
  return call(double{});
}

}  // namespace

struct RasterWriter::File {
  std::string path, format;
  Size size;
  CellType type;
  Run run;
  WriteOptions options;
  StagedFile staged;
  std::string plain;  // what is written row by row: the file itself, or a GeoTIFF to copy from
  DatasetPtr dataset;
  std::optional<double> nodata;
  int row = 0;

  File(const std::string& name, std::string driver, Size raster, CellType cell_type,
       const WriteOptions& write_options, const Run& how)
      : path(name),
        format(std::move(driver)),
        size(raster),
        type(cell_type),
        run(how),
        options(write_options),
        staged(path, options.overwrite),
        plain(format == "COG" ? staged.path() + ".plain" : staged.path()) {}

  template <class T>
  void write(const Dem& rows, const Raster<double>& exact) {
    const GdalErrors errors;
    std::vector<T> cells(rows.size().cells());
    const T unknown = nodata ? T(*nodata) : T(0);
    const bool apart = to_cells<T>(path, rows.z.cells(), exact.cells(), rows.known.cells(), unknown,
                                   std::span<T>(cells));
    if (nodata && !apart)
      throw IoError(path, fmt::format("no-data {} is also an elevation; choose another with "
                                      "--out-nodata",
                                      *nodata));
    if (!nodata && count(rows.known) < rows.size().cells())
      throw IoError(path,
                    "unknown cells remain and no value says so; choose one with --out-nodata");
    const CPLErr error = GDALRasterIO(GDALGetRasterBand(dataset.get(), 1), GF_Write, 0, row,
                                      size.cols, rows.size().rows, cells.data(), size.cols,
                                      rows.size().rows, gdal_type(type), 0, 0);
    if (error != CE_None || errors.any()) errors.fail(path, "cannot be written");
  }
};

RasterWriter::RasterWriter(const std::string& path, Size size, const GeoRef& ref,
                           const Source& source, const WriteOptions& options, const Run& run) {
  const std::string format = options.format.empty() ? gdal_format_of(path) : options.format;
  if (format != "GTiff" && format != "COG")
    throw IoError(path, fmt::format("{} cannot be written part by part; must be GTiff or COG",
                                    format.empty() ? "a file of this extension" : format));
  file_ =
      std::make_unique<File>(path, format, size, options.type.value_or(source.type), options, run);
  File& f = *file_;
  const GdalErrors errors;
  const auto list = creation_options("GTiff", f.type, options, run);
  f.dataset.reset(GDALCreate(checked_driver(path, "GTiff"), f.plain.c_str(), size.cols, size.rows,
                             1, gdal_type(f.type), const_cast<char**>(list.List())));
  if (!f.dataset) errors.fail(path, "cannot be written");
  with_type(f.type, [&]<class T>(T) {
    if (const auto nodata = choose_nodata<T>(path, source, options)) f.nodata = double(*nodata);
  });
  describe_dataset(f.dataset.get(), ref, f.type, f.nodata, source, options);
}
RasterWriter::~RasterWriter() = default;

void RasterWriter::write(const Dem& rows, const Raster<double>& exact) {
  if (rows.size().cols != file_->size.cols || file_->row + rows.size().rows > file_->size.rows)
    throw std::logic_error("rows of another raster");
  with_type(file_->type, [&]<class T>(T) { file_->write<T>(rows, exact); });
  file_->row += rows.size().rows;
}

void RasterWriter::commit() {
  File& f = *file_;
  const GdalErrors errors;  // those of closing too: a full disk often shows only then
  if (f.row != f.size.rows) throw std::logic_error("rows of the raster are missing");
  if (f.format == "COG") {
    GdalProgress progress(f.run, "writing");
    const auto list = creation_options("COG", f.type, f.options, f.run);
    GDALFlushCache(f.dataset.get());
    DatasetPtr cog(GDALCreateCopy(checked_driver(f.path, "COG"), f.staged.path().c_str(),
                                  f.dataset.get(), TRUE, const_cast<char**>(list.List()),
                                  GdalProgress::call, &progress));
    const bool complete = cog != nullptr;
    cog.reset();
    progress.rethrow();
    if (!complete || errors.any()) errors.fail(f.path, "cannot be written");
  }
  f.dataset.reset();
  if (errors.any()) errors.fail(f.path, "cannot be written");
  if (f.plain != f.staged.path()) VSIUnlink(f.plain.c_str());
  f.staged.commit();
}

}  // namespace dem
