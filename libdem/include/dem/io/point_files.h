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
  // Columns of text or fields of a vector layer, by name or by number from 1. "": they are found by
  // their usual names; otherwise they are the first three columns, or the geometry of a vector
  // layer.
  std::string x_field{}, y_field{}, z_field{};
  std::string sigma_field{};   ///< standard error of z; "": none
  std::string weight_field{};  ///< weight of z; "": none
  /// A text column with the whole position: MGRS, UTM ("32T 465005 5080000"), or latitude and
  /// longitude in degrees, minutes, seconds.
  std::string position_field{};
  std::optional<char> delimiter{};  ///< of text; default: the first of tab ; | , or spaces
  /// Distance between the points on lines of a vector layer, in the units of the file; 0: their
  /// vertices.
  double along_lines = 0;
  std::string layer{};             ///< of a vector file; "": the only one
  std::vector<int> classes{};      ///< of LAS points; empty: all but withheld ones
  std::optional<double> nodata{};  ///< a z that means "no elevation"
  /// The coordinate system of x and y ("EPSG:25832", PROJ or WKT). It overrides the one in the
  /// file.
  std::string crs{};
  /// The coordinate system into which x and y are transformed; "": they stay unchanged. Points
  /// without a system are treated as being in this one.
  std::string to_crs{};
};
/// All but `delimiter` and `classes`.
std::vector<Field> fields(PointReadOptions& options);

/// What is known of a file of points after it was read.
struct PointSource {
  std::string format;              ///< "text", "LAS 1.2", or GDAL's driver name
  std::string crs_wkt;             ///< of the delivered x and y; "": unknown
  std::vector<std::string> notes;  ///< how it was read, one sentence each
  std::size_t points = 0;          ///< delivered
  std::size_t without_z = 0;       ///< rows without an elevation (empty, NaN, nodata) or position
  std::size_t other_class = 0;     ///< LAS points of other classes, or withheld
};

using PointSink = std::function<void(const Points&)>;

/// Reads points and delivers them part by part, in the order of the file.
/// Accepts: text with columns (.csv .txt .tsv .xyz .dat and others, also .gz; "-": standard input),
///          LAS 1.0 to 1.4 uncompressed, and what GDAL opens as a vector layer.
/// Throws:  IoError (the line number is in the message), Cancelled, and what `sink` throws.
PointSource read_points(const std::string& path, const PointReadOptions& options,
                        const PointSink& sink, const Run& run = {});

/// Delivers points that are in memory, as if they stood in a file. Of the options, `crs`, `to_crs`
/// and `nodata` count. Points whose x, y or z is not finite are left out (PointSource::without_z).
/// Throws: std::invalid_argument, Cancelled, and what `sink` throws.
PointSource deliver_points(Points points, const PointReadOptions& options, const PointSink& sink);

/// A contour line in memory.
struct ContourLine {
  double level_m = 0;
  std::vector<double> x, y;
};

/// Delivers the vertices of contour lines in memory, and points along them (`along_lines`), as
/// read_points does for a vector layer.
/// Throws: as deliver_points; std::invalid_argument when the x and y of a line differ in number.
PointSource deliver_contours(const std::vector<ContourLine>& lines, const PointReadOptions& options,
                             const PointSink& sink);

/// The WKT of the coordinate system with a given name ("EPSG:25832", PROJ, WKT, a file).
/// Throws std::invalid_argument.
std::string crs_from_text(const std::string& text);

/// A short name of a coordinate system, such as "WGS 84 / UTM zone 32N"; "none" without one.
std::string crs_name(const std::string& crs_wkt);

}  // namespace dem
