#pragma once
// Files of scattered elevations: text columns, LAS, and the vector formats of GDAL.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dem/points.h"
#include "dem/run.h"

namespace dem {

struct PointReadOptions {
  // Columns of text or fields of a vector layer, by name or by number from 1. "": found by their
  // usual names, else the first three columns; of a vector layer, its geometry.
  std::string x_field{}, y_field{}, z_field{};
  std::string sigma_field{};   ///< standard deviation of z; "": none
  std::string weight_field{};  ///< weight of z; "": none
  /// Text that holds the whole position: MGRS, UTM ("32T 465005 5080000"), or latitude and longitude
  /// in degrees, minutes, seconds.
  std::string position_field{};
  std::optional<char> delimiter{};  ///< of text; default: the first of tab ; | , or spaces it has
  /// Lines of a vector layer get points this far apart, in the file's units; 0: their vertices.
  double along_lines = 0;
  std::string layer{};             ///< of a vector file; "": the only one
  std::vector<int> classes{};      ///< of LAS points; empty: all but withheld ones
  std::optional<double> nodata{};  ///< a z that means none
  /// What x and y are in ("EPSG:25832", PROJ or WKT); overrides what the file says.
  std::string crs{};
  /// What x and y are brought to; "": they stay as they are. Points without any system are taken
  /// as being in it.
  std::string to_crs{};
};
/// All but `delimiter` and `classes`.
std::vector<Field> fields(PointReadOptions& options);

/// What a file of points was found to be.
struct PointSource {
  std::string format;              ///< "text", "LAS 1.2", or GDAL's driver name
  std::string crs_wkt;             ///< of the x and y that were delivered; "": unknown
  std::vector<std::string> notes;  ///< how it was read, a sentence each
  std::size_t points = 0;          ///< delivered
  std::size_t without_z = 0;       ///< rows without an elevation (empty, NaN, no-data) or position
  std::size_t other_class = 0;     ///< LAS points of other classes, or withheld
};

using PointSink = std::function<void(const Points&)>;

/// Reads points and hands them on part by part, in the order of the file.
/// Accepts: text with columns (.csv .txt .tsv .xyz .dat ..., also .gz; "-": standard input), LAS 1.0
///          to 1.4 uncompressed, and what GDAL opens as a vector layer.
/// Throws:  IoError (the line number is in the message), Cancelled, and what `sink` throws.
PointSource read_points(const std::string& path, const PointReadOptions& options,
                        const PointSink& sink, const Run& run = {});

/// The system that a name ("EPSG:25832", PROJ, WKT, a file) stands for, as WKT.
/// Throws std::invalid_argument.
std::string crs_from_text(const std::string& text);

/// A short name of a system, e.g. "WGS 84 / UTM zone 32N"; "none".
std::string crs_name(const std::string& crs_wkt);

}  // namespace dem
