#pragma once
// The readers of points, one a format. Private to dem::io.

#include "dem/io/point_files.h"

namespace dem::io {

/// Takes a part of the points, and may change it. `source.crs_wkt` is known before the first part.
using PointParts = std::function<void(Points&)>;

void read_text_points(const std::string& path, const PointReadOptions& options, PointSource& source,
                      const PointParts& parts, const Run& run);
void read_las_points(const std::string& path, const PointReadOptions& options, PointSource& source,
                     const PointParts& parts, const Run& run);
void read_vector_points(const std::string& path, const PointReadOptions& options,
                        PointSource& source, const PointParts& parts, const Run& run);

/// WGS 84, longitude and latitude.
std::string wgs84();

}  // namespace dem::io
