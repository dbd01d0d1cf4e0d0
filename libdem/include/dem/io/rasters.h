#pragma once
// Elevation files: in and out. The only place where sentinels for "no data" exist.

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/run.h"

namespace dem {

/// A file could not be read or written: "path: cause".
class IoError : public std::runtime_error {
 public:
  IoError(const std::string& path, const std::string& cause)
      : std::runtime_error(path + ": " + cause) {}
};

enum class CellType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// One sign that cells hold no elevation, found while reading.
struct NodataEvidence {
  std::string what{};  ///< "declared value -32768", "mask band", "NaN", "undeclared -9999", ...
  std::uint64_t cells = 0;  ///< how many cells show it
  bool used = false;        ///< whether they were taken as unknown
  std::string why{};        ///< the reason, in a few words
};

/// What a file says beyond its heights; write_dem carries it over to the output.
struct Source {
  std::string path{};
  std::string format{};  ///< "HGT", GDAL's short driver name ("GTiff"), or "image"
  CellType type = CellType::float32;
  std::optional<double> nodata{};  ///< the value that stood for "unknown", if a value did
  bool node_registered = false;  ///< cells are samples at nodes, shared between tiles (as in .hgt)
  std::string vertical_datum{};  ///< as far as the file or the format says, else ""
  std::string band_description{};
  std::vector<std::pair<std::string, std::string>> metadata{};
  std::vector<NodataEvidence> evidence{};

  /// The original values, kept only when float32 cannot hold each of them (float64, int32): so that
  /// known cells are written back bit for bit.
  Raster<double> exact{};
};

/// Heights between two grey levels of an image: black = low_m, white = high_m.
struct HeightRange {
  double low_m = 0;
  double high_m = 1;
};

struct ReadOptions {
  int band = 0;                    ///< 1, 2, ...; 0: the only one, else an error names the bands
  std::optional<double> nodata{};  ///< this value means unknown; overrides what is declared
  bool detect_nodata = true;       ///< look for undeclared -32768, -32767, -9999, 32767
  std::string tile{};              ///< "N36E008" for an .hgt whose name does not say
  std::optional<HeightRange> heights{};  ///< read as a heightmap image, through OpenImageIO
  /// Grey of an image that means unknown, 0 (black) to 1 (white).
  std::optional<double> unknown_grey{};
};
/// All but `heights`.
std::vector<Field> fields(ReadOptions& options);

struct DemFile {
  Dem dem;
  Source source;
};

/// Reads one band of elevations.
/// Accepts: .hgt, .hgt.gz, .hgt.zip of any square size from 2 up, by our own reader; images (.png,
///          .exr, .jpg or with `heights`) by OpenImageIO; everything else that GDAL opens, its
///          /vsizip/, /vsigzip/, /vsicurl/ paths included, and a folder of tiles as one raster.
/// Gives:   unknown cells have known = 0 and z = 0; no NaN, no infinity, no sentinel remains.
/// Throws:  IoError, Cancelled.
DemFile read_dem(const std::string& path, const ReadOptions& options = {}, const Run& run = {});

/// A value of a raster of kinds, for legends: 1 = "filled by method", in a colour.
struct CellClass {
  int value = 0;
  std::string name{};
  std::array<std::uint8_t, 3> rgb{};
};

struct WriteOptions {
  std::string format{};            ///< GDAL driver name, "HGT" or "image"; "": from the extension
  std::optional<CellType> type{};  ///< default: that of the source
  std::optional<double> nodata{};  ///< default: the source's, else one that no elevation has
  bool compress = true;            ///< GeoTIFF, COG: DEFLATE with predictor, tiled
  bool overwrite = false;          ///< an existing file is refused otherwise
  /// For images. Default: that of the source if all elevations lie in it, else lowest to highest;
  /// .exr: plain metres.
  std::optional<HeightRange> heights{};
  std::optional<double> unknown_grey{};  ///< for images; default: alpha 0 marks unknown cells
  std::vector<std::pair<std::string, std::string>> metadata{};  ///< added to the source's
  /// The cells are kinds, not heights: a colour table, and CLASS_1=NAME in the metadata.
  std::vector<CellClass> classes{};
};
/// All but `heights`, `metadata` and `classes`.
std::vector<Field> fields(WriteOptions& options);

/// The names of the cell types, in their order: "int8", "uint8", ...
const std::vector<std::string>& cell_type_names();

/// Writes a DEM so that the path holds either what it held before or the whole new file: it is
/// written beside and renamed. Unknown cells get the no-data value, which is always declared.
/// Integer types get rounded values; a value outside the type's range is an error, not a wrap.
/// `source`: what to carry over (type, no-data, band description, metadata); {} for a new DEM.
/// Throws:   IoError (exists, no such folder, disk full, no such format ...), Cancelled.
void write_dem(const std::string& path, const Dem& dem, const Source& source = {},
               const WriteOptions& options = {}, const Run& run = {});

/// Throws IoError when `path` exists and overwriting was not asked for, or its folder does not
/// exist or cannot be written: to be asked before long work.
void check_writable(const std::string& path, bool overwrite);

/// The .hgt and .tif files of a folder, by name. Throws IoError when there is none.
std::vector<std::string> tiles_in(const std::string& folder);

/// Writes text so that the path holds either what it held before or the whole new text.
void write_text(const std::string& path, const std::string& text, bool overwrite);

}  // namespace dem
