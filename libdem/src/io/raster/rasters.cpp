#include "dem/io/rasters.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "dem/io/geodesy.h"
#include "dem/io/raster_stream.h"
#include "io/raster/gdal_raster.h"
#include "io/raster/heightmap.h"
#include "io/raster/hgt.h"
#include "io/raster/tile_folder.h"
#include "io/staged_file.h"

namespace dem {
using namespace io;
namespace {

/// An empty file is told as such before any format guesses at it.
void check_not_empty(const std::string& path) {
  namespace fs = std::filesystem;
  if (path.starts_with("/vsi")) return;
  std::error_code error;
  if (fs::is_regular_file(path, error) && fs::file_size(path, error) == 0)
    throw IoError(path, "is empty (0 bytes)");
}

/// What a RasterWriter can write and GDAL cannot by itself.
void write_by_parts(const std::string& path, const Dem& dem, const Source& source,
                    const WriteOptions& options, const Run& run) {
  constexpr int rows_at_once = 256;
  const auto [cols, rows] = dem.size();
  RasterWriter writer(path, dem.size(), dem.ref, source, options, run);
  for (int row = 0; row < rows; row += rows_at_once) {
    run.report(double(row) / rows, "writing");
    const Box box{0, row, cols, std::min(rows_at_once, rows - row)};
    Raster<double> exact;
    if (source.exact.size() == dem.size()) exact = crop(source.exact, box);
    writer.write(crop(dem, box, dem.spacing), exact);
  }
  writer.commit();
}

}  // namespace

std::vector<Field> fields(ReadOptions& o) {
  return {{"band", o.band, {0, 65535}, "", "number of the band from 1; 0: the only one"},
          {"nodata", o.nodata, {.or_nan = true}, "m", "this value is nodata, whatever is declared"},
          {"detect_nodata", o.detect_nodata, "find undeclared nodata -32768, -32767, -9999, 32767"},
          {"tile", o.tile, "name of an .hgt tile whose file name does not tell it, as in N36E008"},
          {"unknown_grey",
           o.unknown_grey,
           {0, 1},
           "",
           "grey level of an image that is nodata, from 0 (black) to 1 (white)"}};
}

const std::vector<std::string>& cell_type_names() {
  static const std::vector<std::string> names{"int8",  "uint8",  "int16",   "uint16",
                                              "int32", "uint32", "float32", "float64"};
  return names;
}

std::vector<Field> fields(WriteOptions& o) {
  return {
      {"format", o.format, "GDAL driver name, HGT or image; \"\": by the extension"},
      {"type", o.type, cell_type_names(), "cell type; unset: that of the source"},
      {"nodata",
       o.nodata,
       {.or_nan = true},
       "m",
       "nodata value that the file declares; unset: that of the source, or one that no cell has"},
      {"compress", o.compress, "compress GeoTIFF and COG losslessly, in tiles"},
      {"overwrite", o.overwrite, "replace a file that exists"},
      {"unknown_grey",
       o.unknown_grey,
       {0, 1},
       "",
       "grey level of nodata in an image, from 0 (black) to 1 (white); unset: transparent"}};
}

DemFile read_dem(const std::string& path, const ReadOptions& options, const Run& run) {
  check_options(options);
  const bool grey = options.heights || options.unknown_grey;
  const bool list = is_list_of_files(path);
  const bool hgt = !list && is_hgt_name(path);
  if (hgt && grey)
    throw IoError(path, "is an .hgt, whose heights are metres; it takes no grey levels");
  if (!hgt && !options.tile.empty())
    throw IoError(path, fmt::format("is no .hgt; tile {} has no meaning for it", options.tile));
  check_not_empty(path);

  DemFile file = hgt                                      ? read_hgt(path, options, run)
                 : !list && (grey || is_image_name(path)) ? read_heightmap(path, options, run)
                                                          : read_gdal(path, options, run);
  try {
    set_spacing(file.dem);
  } catch (const std::invalid_argument& error) {
    throw IoError(path, error.what());
  }
  return file;
}

void write_dem(const std::string& path, const Dem& dem, const Source& source,
               const WriteOptions& options, const Run& run) {
  check_shape(dem);
  check_options(options);
  const bool image =
      options.format == "image" ||
      (options.format.empty() && (is_image_name(path) || options.heights || options.unknown_grey));
  if (image) return write_heightmap(path, dem, source, options, run);
  if (options.heights || options.unknown_grey)
    throw IoError(path, "a range of heights and a grey for unknown cells are for images only");
  const bool hgt = options.format == "HGT" || (options.format.empty() && is_hgt_name(path));
  const std::string format = options.format.empty() ? gdal_format_of(path) : options.format;
  if (hgt || format == "VRT" || is_tile_folder(path))
    return write_by_parts(path, dem, source, options, run);
  if (format.empty())
    throw IoError(path, "its extension names no format that can be written", "format");
  write_gdal(path, format, dem, source, options, run);
}

void check_writable(const std::string& path, const WriteOptions& options) {
  check_writable(path, options.overwrite);
  std::string format = options.format;
  if (format.empty())
    format = is_image_name(path) || options.heights || options.unknown_grey ? "image"
             : is_hgt_name(path) || is_tile_folder(path)                    ? "HGT"
                                                                            : gdal_format_of(path);
  if (format.empty())
    throw IoError(path, "its extension names no format that can be written; give the format");
  const bool of_gdal = format != "image" && format != "HGT";
  if (of_gdal && is_tile_folder(path))
    throw IoError(
        path,
        fmt::format("a folder takes .hgt tiles, no {}; name a .vrt for tiles of GeoTIFF", format));
  if (!of_gdal && !options.creation_options.empty())
    throw IoError(path, fmt::format("creation option {}: {} takes none",
                                    options.creation_options.front().first,
                                    format == "HGT" ? "an .hgt" : "an image"));
  if (format == "HGT" && options.type.value_or(CellType::int16) != CellType::int16)
    throw IoError(path, "an .hgt holds int16 only");
  if (of_gdal) check_creation_options(path, format == "VRT" ? "GTiff" : format, options);
}

void check_writable(const std::string& path, bool overwrite) {
  if (is_tile_folder(path)) {
    TileFolder folder(path, overwrite);
    return;
  }
  StagedFile file(path, overwrite);
  if (extension(path) == ".vrt") TileFolder folder(tile_folder_of(path), overwrite);
}

}  // namespace dem
