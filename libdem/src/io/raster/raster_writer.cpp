// Rasters written row by row: into one file, or into tiles.

#include <cpl_minixml.h>
#include <cpl_string.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <type_traits>
#include <vector>

#include "dem/io/raster_stream.h"
#include "io/gdal_support.h"
#include "io/raster/cells.h"
#include "io/raster/gdal_raster.h"
#include "io/raster/hgt.h"
#include "io/raster/tile_folder.h"
#include "io/staged_file.h"

namespace dem {
using namespace io;
namespace fs = std::filesystem;

/// What a format does with rows that come from the north to the south.
struct RasterWriter::File {
  virtual ~File() = default;
  virtual void write(const Dem& rows, const Raster<double>& exact) = 0;
  virtual void close() = 0;  ///< all of it is on the disk, though not under its name
  virtual void commit() = 0;
};

namespace {

constexpr int tile_cells = 4096;  // to a side of the tiles of a VRT

// --- GeoTIFF

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
                    fmt::format("nodata {} does not fit the type, {} to {}", *options.nodata,
                                std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max()));
    return T(*options.nodata);
  }
  if (source.nodata && fits(*source.nodata)) return T(*source.nodata);
  if constexpr (sizeof(T) == 1) return std::nullopt;
  if (std::is_unsigned_v<T>) return std::numeric_limits<T>::max();
  return T(std::is_same_v<T, std::int16_t> ? -32768 : -9999);
}

std::optional<double> nodata_of(const std::string& path, CellType type, const Source& source,
                                const WriteOptions& options) {
  return with_type(type, [&]<class T>(T) -> std::optional<double> {
    if (const auto nodata = choose_nodata<T>(path, source, options)) return double(*nodata);
    return std::nullopt;
  });
}

class TiffFile : public RasterWriter::File {
 public:
  TiffFile(const std::string& path, bool cog, Size size, const GeoRef& ref, const Source& source,
           const WriteOptions& options, const Run& run)
      : path_(path),
        cog_(cog),
        type_(options.type.value_or(source.type)),
        run_(run),
        options_(options),
        staged_(path, options.overwrite),
        plain_(cog ? staged_.path() + ".plain" : staged_.path()),
        nodata_(nodata_of(path, type_, source, options)) {
    const GdalErrors errors;
    WriteOptions own = options;
    if (cog) own.creation_options.clear();  // those are for the copy
    const auto list = creation_options("GTiff", type_, own, run);
    dataset_.reset(GDALCreate(checked_driver(path, "GTiff"), plain_.c_str(), size.cols, size.rows,
                              1, gdal_type(type_), const_cast<char**>(list.List())));
    if (!dataset_) errors.fail(path, "cannot be written");
    describe_dataset(dataset_.get(), ref, type_, nodata_, source, options);
  }

  void write(const Dem& rows, const Raster<double>& exact) override {
    with_type(type_, [&]<class T>(T) { write_cells<T>(rows, exact); });
    row_ += rows.size().rows;
  }

  void close() override {
    const GdalErrors errors;  // those of closing too: a full disk often shows only then
    if (cog_) write_cog(errors);
    dataset_.reset();
    if (errors.any()) errors.fail(path_, "cannot be written");
    if (cog_) VSIUnlink(plain_.c_str());
  }

  void commit() override { staged_.commit(); }

 private:
  template <class T>
  void write_cells(const Dem& rows, const Raster<double>& exact) {
    const GdalErrors errors;
    std::vector<T> cells(rows.size().cells());
    const T unknown = nodata_ ? T(*nodata_) : T(0);
    const bool apart = to_cells<T>(path_, rows.z.cells(), exact.cells(), rows.known.cells(),
                                   unknown, std::span<T>(cells));
    if (nodata_ && !apart)
      throw IoError(path_,
                    fmt::format("nodata {} is also an elevation; another must be chosen", *nodata_),
                    "out_nodata");
    if (!nodata_ && count(rows.known) < rows.size().cells())
      throw IoError(path_, "unknown cells remain and no value says so; one must be chosen",
                    "out_nodata");
    const auto [cols, n] = rows.size();
    const CPLErr error = GDALRasterIO(GDALGetRasterBand(dataset_.get(), 1), GF_Write, 0, row_, cols,
                                      n, cells.data(), cols, n, gdal_type(type_), 0, 0);
    if (error != CE_None || errors.any()) errors.fail(path_, "cannot be written");
  }

  void write_cog(const GdalErrors& errors) {
    GdalProgress progress(run_, "writing");
    const auto list = creation_options("COG", type_, options_, run_);
    GDALFlushCache(dataset_.get());
    DatasetPtr cog(GDALCreateCopy(checked_driver(path_, "COG"), staged_.path().c_str(),
                                  dataset_.get(), TRUE, const_cast<char**>(list.List()),
                                  GdalProgress::call, &progress));
    const bool complete = cog != nullptr;
    cog.reset();
    progress.rethrow();
    if (!complete || errors.any()) errors.fail(path_, "cannot be written");
  }

  std::string path_;
  bool cog_;
  CellType type_;
  Run run_;
  WriteOptions options_;
  StagedFile staged_;
  std::string plain_;  // what is written row by row: the file itself, or a GeoTIFF to copy from
  std::optional<double> nodata_;
  DatasetPtr dataset_;
  int row_ = 0;
};

// --- .hgt

class HgtFile : public RasterWriter::File {
 public:
  HgtFile(const std::string& path, Size size, const GeoRef& ref, const WriteOptions& options)
      : writer_(path, size, ref, options) {}
  void write(const Dem& rows, const Raster<double>&) override {
    writer_.write(rows.z.cells(), rows.known.cells());
  }
  void close() override { writer_.close(); }
  void commit() override { writer_.commit(); }

 private:
  HgtWriter writer_;
};

// --- Tiles

/// Whatever the format of each is: files of a folder that together hold a raster. They are all
/// written before the first of them appears.
class TileFiles : public RasterWriter::File {
 public:
  struct Tile {
    Box box;
    std::function<std::unique_ptr<File>()> open;
  };

  TileFiles(TileFolder folder, std::vector<Tile> tiles)
      : folder_(std::move(folder)), waiting_(std::move(tiles)) {
    std::ranges::reverse(waiting_);  // the first one last
  }

  void write(const Dem& rows, const Raster<double>& exact) override {
    const Box part{0, row_, rows.size().cols, rows.size().rows};
    row_ += part.rows;
    for (; !waiting_.empty() && waiting_.back().box.row < row_; waiting_.pop_back())
      open_.push_back({waiting_.back().box, waiting_.back().open(), false});
    for (Open& tile : open_) write(tile, part, rows, exact);
    std::erase_if(open_, [&](Open& tile) {
      if (tile.box.row + tile.box.rows > row_) return false;
      tile.file->close();
      if (tile.has_data) done_.push_back(std::move(tile.file));  // else no file: as for the sea
      return true;
    });
  }

  void close() override {}

  void commit() override {
    for (const auto& tile : done_) tile->commit();
    folder_.keep();
  }

 private:
  struct Open {
    Box box;
    std::unique_ptr<File> file;
    bool has_data;
  };

  static void write(Open& tile, const Box& part, const Dem& rows, const Raster<double>& exact) {
    const int begin = std::max(tile.box.row, part.row);
    const int end = std::min(tile.box.row + tile.box.rows, part.row + part.rows);
    if (begin >= end) return;
    const Box own{tile.box.col, begin - part.row, tile.box.cols, end - begin};
    const Dem cells = crop(rows, own, rows.spacing);
    tile.has_data = tile.has_data || count(cells.known) > 0;
    tile.file->write(cells, exact.empty() ? exact : crop(exact, own));
  }

  TileFolder folder_;
  std::vector<Tile> waiting_;
  std::vector<Open> open_;
  std::vector<std::unique_ptr<File>> done_;
  int row_ = 0;
};

std::unique_ptr<RasterWriter::File> hgt_folder(const std::string& path, Size size,
                                               const GeoRef& ref, WriteOptions options) {
  options.format = "HGT";
  options.metadata.clear();
  const std::vector<HgtTile> layout = hgt_tiles(path, size, ref);
  TileFolder folder(path, options.overwrite);
  std::vector<TileFiles::Tile> tiles;
  for (const HgtTile& tile : layout)
    tiles.push_back({tile.box, [=, name = folder.file(tile.name)] {
                       return std::make_unique<HgtFile>(name, tile.box.size(), crop(ref, tile.box),
                                                        options);
                     }});
  return std::make_unique<TileFiles>(std::move(folder), std::move(tiles));
}

/// A VRT beside a folder of GeoTIFFs.
class VrtFile : public RasterWriter::File {
 public:
  VrtFile(const std::string& path, Size size, const GeoRef& ref, const Source& source,
          WriteOptions options, const Run& run)
      : path_(path), staged_(path, options.overwrite) {
    const CellType type = options.type.value_or(source.type);
    const auto nodata = nodata_of(path, type, source, options);
    options.nodata = nodata;
    options.format = "GTiff";
    TileFolder folder(tile_folder_of(path), options.overwrite);
    {
      const GdalErrors errors;
      const GDALDriverH driver = GDALGetDriverByName("VRT");
      dataset_.reset(GDALCreate(driver, staged_.path().c_str(), size.cols, size.rows, 1,
                                gdal_type(type), nullptr));
      if (!dataset_) errors.fail(path, "cannot be written");
      describe_dataset(dataset_.get(), ref, type, nodata, source, options);
    }
    std::vector<TileFiles::Tile> tiles;
    for (int row = 0; row < size.rows; row += tile_cells)
      for (int col = 0; col < size.cols; col += tile_cells) {
        const Box box{col, row, std::min(tile_cells, size.cols - col),
                      std::min(tile_cells, size.rows - row)};
        const std::string name = fmt::format("{:03}_{:03}.tif", row / tile_cells, col / tile_cells);
        add_source(fs::path(folder.path()).filename() / name, box);
        tiles.push_back({box, [=, file = folder.file(name)] {
                           return std::make_unique<TiffFile>(file, false, box.size(),
                                                             crop(ref, box), source, options, run);
                         }});
      }
    tiles_ = std::make_unique<TileFiles>(std::move(folder), std::move(tiles));
  }

  void write(const Dem& rows, const Raster<double>& exact) override { tiles_->write(rows, exact); }

  void close() override {
    const GdalErrors errors;
    dataset_.reset();
    if (errors.any()) errors.fail(path_, "cannot be written");
  }

  void commit() override {
    tiles_->commit();
    staged_.commit();
  }

 private:
  void add_source(const fs::path& name, const Box& box) {
    char* const escaped = CPLEscapeString(name.string().c_str(), -1, CPLES_XML);
    const std::string rect = fmt::format("xSize=\"{}\" ySize=\"{}\"", box.cols, box.rows);
    const std::string xml = fmt::format(
        "<SimpleSource><SourceFilename relativeToVRT=\"1\">{}</SourceFilename>"
        "<SourceBand>1</SourceBand><SrcRect xOff=\"0\" yOff=\"0\" {}/>"
        "<DstRect xOff=\"{}\" yOff=\"{}\" {}/></SimpleSource>",
        escaped, rect, box.col, box.row, rect);
    CPLFree(escaped);
    GDALSetMetadataItem(GDALGetRasterBand(dataset_.get(), 1), "source_0", xml.c_str(),
                        "new_vrt_sources");
  }

  std::string path_;
  StagedFile staged_;
  DatasetPtr dataset_;
  std::unique_ptr<TileFiles> tiles_;
};

std::unique_ptr<RasterWriter::File> open_file(const std::string& path, Size size, const GeoRef& ref,
                                              const Source& source, const WriteOptions& options,
                                              const Run& run) {
  if (is_tile_folder(path)) {
    if (!options.format.empty() && options.format != "HGT")
      throw IoError(path, fmt::format("a folder takes .hgt tiles, no {}; name a .vrt for tiles of "
                                      "GeoTIFF",
                                      options.format));
    return hgt_folder(path, size, ref, options);
  }
  const std::string format = !options.format.empty() ? options.format
                             : is_hgt_name(path)     ? "HGT"
                                                     : gdal_format_of(path);
  if (format == "HGT") return std::make_unique<HgtFile>(path, size, ref, options);
  if (format == "VRT") return std::make_unique<VrtFile>(path, size, ref, source, options, run);
  if (format == "GTiff" || format == "COG")
    return std::make_unique<TiffFile>(path, format == "COG", size, ref, source, options, run);
  throw IoError(path, fmt::format("{} cannot be written part by part; must be GTiff, COG, VRT, HGT "
                                  "or a folder (ending in /) of .hgt",
                                  format.empty() ? "a file of this extension" : format));
}

}  // namespace

RasterWriter::RasterWriter(const std::string& path, Size size, const GeoRef& ref,
                           const Source& source, const WriteOptions& options, const Run& run)
    : size_(size) {
  check_options(options);
  file_ = open_file(path, size, ref, source, options, run);
}
RasterWriter::~RasterWriter() = default;

void RasterWriter::write(const Dem& rows, const Raster<double>& exact) {
  row_ += rows.size().rows;
  if (rows.size().cols != size_.cols || row_ > size_.rows)
    throw std::logic_error("rows of another raster");
  file_->write(rows, exact);
}

void RasterWriter::commit() {
  if (row_ != size_.rows) throw std::logic_error("rows of the raster are missing");
  file_->close();
  file_->commit();
}

}  // namespace dem
