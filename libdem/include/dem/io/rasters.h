#pragma once
// Reading and writing elevation files. Nodata values exist only here.

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
  IoError(const std::string& path, const std::string& cause, std::string field = "")
      : std::runtime_error(path + ": " + cause), field_(std::move(field)) {}

  /// The option that would help, by the name of its field ("overwrite"), or "".
  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

enum class CellType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// One indication that cells have no elevation, found while reading.
struct NodataEvidence {
  std::string what{};  ///< "declared value -32768", "mask band", "NaN", "undeclared -9999", ...
  std::uint64_t cells = 0;  ///< number of these cells
  bool used = false;        ///< whether they are unknown in the DEM
  std::string why{};        ///< the reason, in a few words
};

/// What a file says in addition to its heights. write_dem copies it to the output.
struct Source {
  std::string path{};
  std::string format{};  ///< "HGT", GDAL's short driver name ("GTiff"), or "image"
  CellType type = CellType::float32;
  std::optional<double> nodata{};  ///< the value that meant "unknown", if any
  bool node_registered = false;  ///< cells are samples at nodes, shared between tiles (as in .hgt)
  std::string vertical_datum{};  ///< as the file or the format says; else ""
  std::string band_description{};
  std::vector<std::pair<std::string, std::string>> metadata{};
  std::vector<NodataEvidence> evidence{};

  /// The original values, if float32 cannot hold each of them (float64, int32). With them, known
  /// cells are written back bit for bit.
  Raster<double> exact{};
};

/// The heights of the two ends of the grey scale of an image: black = low_m, white = high_m.
struct HeightRange {
  double low_m = 0;
  double high_m = 1;
};

struct ReadOptions {
  int band = 0;                          ///< 1, 2, ...; 0: the only one; an error names several
  std::optional<double> nodata{};        ///< this value means unknown; overrides the declared one
  bool detect_nodata = true;             ///< look for undeclared -32768, -32767, -9999, 32767
  std::string tile{};                    ///< "N36E008" for an .hgt whose name does not say it
  std::optional<HeightRange> heights{};  ///< read as a heightmap image, through OpenImageIO
  /// The grey of an image that means unknown, from 0 (black) to 1 (white).
  std::optional<double> unknown_grey{};
};
/// All but `heights`.
std::vector<Field> fields(ReadOptions& options);

struct DemFile {
  Dem dem;
  Source source;
};

/// Reads one band of elevations.
/// Accepts: .hgt, .hgt.gz and .hgt.zip of any square size from 2 up, by a reader of libdem; images
///          (.png and .exr, or .jpg with `heights`) by OpenImageIO; everything else that GDAL
///          opens, including /vsizip/, /vsigzip/ and /vsicurl/ paths; a folder of tiles as one
///          raster, or several paths, each on a line of its own.
/// Gives:   unknown cells have known = 0 and z = 0. No NaN, infinity or nodata value remains.
/// Throws:  IoError, Cancelled.
DemFile read_dem(const std::string& path, const ReadOptions& options = {}, const Run& run = {});

/// A value of a raster of classes, with its colour, for legends: 1 = "filled by method".
struct CellClass {
  int value = 0;
  std::string name{};
  std::array<std::uint8_t, 3> rgb{};
};

struct WriteOptions {
  std::string format{};            ///< GDAL driver name, "HGT" or "image"; "": from the extension
  std::optional<CellType> type{};  ///< default: the type of the source
  std::optional<double> nodata{};  ///< default: the source's, else one that no cell has
  bool compress = true;            ///< GeoTIFF, COG: DEFLATE with predictor, tiled
  bool overwrite = false;          ///< if false, an existing file is an error
  /// For images. Default: the range of the source if all elevations lie in it, otherwise lowest to
  /// highest. .exr: plain metres.
  std::optional<HeightRange> heights{};
  std::optional<double> unknown_grey{};  ///< for images; default: alpha 0 marks unknown cells
  std::vector<std::pair<std::string, std::string>> metadata{};  ///< added to the source's
  /// For the driver of GDAL, such as {{"COMPRESS", "ZSTD"}}. They override `compress`. An .hgt and
  /// an image take none.
  std::vector<std::pair<std::string, std::string>> creation_options{};
  /// The cells are classes and not heights. The file gets a colour table, and CLASS_1=NAME in its
  /// metadata.
  std::vector<CellClass> classes{};
};
/// All but `heights`, `metadata`, `creation_options` and `classes`.
std::vector<Field> fields(WriteOptions& options);

/// The names of the cell types, in their order: "int8", "uint8", ...
const std::vector<std::string>& cell_type_names();

/// Writes a DEM. The path holds either what it held before or the whole new file, because the file
/// is written under a temporary name next to it and then renamed.
/// Unknown cells get the nodata value, which is always declared. Integer types get rounded values.
/// A value outside the range of the type is an error and does not wrap.
/// `source` is what to copy (type, nodata, band description, metadata); {} for a new DEM.
/// Throws: IoError (the file exists, no such folder, disk full, no such format and others),
///         Cancelled.
void write_dem(const std::string& path, const Dem& dem, const Source& source = {},
               const WriteOptions& options = {}, const Run& run = {});

/// Throws IoError when `path` exists and `overwrite` is false, or when its folder does not exist or
/// is not writable. Call it before long work.
void check_writable(const std::string& path, bool overwrite);

/// As above. Also throws IoError when the format is unknown or cannot be written, or when it does
/// not take the type or one of the creation options.
void check_writable(const std::string& path, const WriteOptions& options);

/// The .hgt and .tif files of a folder, sorted by name. Throws IoError when there is none.
std::vector<std::string> tiles_in(const std::string& folder);

/// Writes text. The path holds either what it held before or the whole new text.
void write_text(const std::string& path, const std::string& text, bool overwrite);

}  // namespace dem
