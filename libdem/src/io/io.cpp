#include "dem/io.h"

#include <fmt/format.h>

#include <filesystem>

#include "dem/geodesy.h"
#include "dem/raster_stream.h"
#include "gdal_raster.h"
#include "heightmap.h"
#include "hgt.h"
#include "staged_file.h"

namespace dem {
namespace {

bool is_image_name(const std::string& path) {
  const std::string ext = extension(path);
  return ext == ".png" || ext == ".exr" || ext == ".jpg" || ext == ".jpeg";
}

/// An empty file is told as such before any format guesses at it.
void check_not_empty(const std::string& path) {
  namespace fs = std::filesystem;
  if (path.starts_with("/vsi")) return;
  std::error_code error;
  if (fs::is_regular_file(path, error) && fs::file_size(path, error) == 0)
    throw IoError(path, "is empty (0 bytes)");
}

}  // namespace

bool reads_by_parts(const std::string& path) { return !is_hgt_name(path) && !is_image_name(path); }

DemFile read_dem(const std::string& path, const ReadOptions& options, const Run& run) {
  const bool grey = options.heights || options.unknown_grey;
  const bool hgt = is_hgt_name(path);
  if (hgt && grey)
    throw IoError(path, "is an .hgt, whose heights are metres; it takes no grey levels");
  if (!hgt && !options.tile.empty())
    throw IoError(path, fmt::format("is no .hgt; --tile {} has no meaning for it", options.tile));
  check_not_empty(path);

  DemFile file = hgt                           ? read_hgt(path, options, run)
                 : grey || is_image_name(path) ? read_heightmap(path, options, run)
                                               : read_gdal(path, options, run);
  try {
    file.dem.spacing = middle_spacing(file.dem.ref, file.dem.size());
  } catch (const std::invalid_argument& error) {
    throw IoError(path, error.what());
  }
  return file;
}

void write_dem(const std::string& path, const Dem& dem, const Source& source,
               const WriteOptions& options, const Run& run) {
  check_shape(dem);
  const bool image =
      options.format == "image" ||
      (options.format.empty() && (is_image_name(path) || options.heights || options.unknown_grey));
  if (image) return write_heightmap(path, dem, source, options, run);
  if (options.heights || options.unknown_grey)
    throw IoError(path, "a range of heights and a grey for unknown cells are for images only");
  if (options.format == "HGT" || (options.format.empty() && is_hgt_name(path)))
    return write_hgt(path, dem, options, run);

  const std::string format = options.format.empty() ? gdal_format_of(path) : options.format;
  if (format.empty())
    throw IoError(path, "its extension names no format that can be written; give --format");
  write_gdal(path, format, dem, source, options, run);
}

}  // namespace dem
