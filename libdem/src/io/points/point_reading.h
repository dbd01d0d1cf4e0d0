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

/// A vertex of a line or a point, with its elevation.
struct Vertex {
  double x = 0, y = 0, z = 0;
  bool finite() const;
};

/// Adds a vertex to the points; one that is not finite is counted in `without_z` instead.
void add_point(const Vertex& vertex, std::size_t& without_z, Points& points);

/// Adds points between two vertices of a line, at most `spacing` apart.
void add_between(const Vertex& a, const Vertex& b, double spacing, Points& points);

/// WGS 84, longitude and latitude.
std::string wgs84();

}  // namespace dem::io
