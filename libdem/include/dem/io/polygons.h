#pragma once
// Polygons of vector files, read and written, and breaklines.

#include <memory>
#include <string>
#include <vector>

#include "dem/breaklines.h"
#include "dem/dem.h"
#include "dem/holes.h"

namespace dem {

/// The polygons of a vector file, in cells of a raster.
class Polygons {
 public:
  /// All polygons of all layers, transformed into the coordinates of the raster.
  /// Throws IoError when the file cannot be read, has no polygon, or has no coordinate system while
  /// the raster has one.
  Polygons(const std::string& path, const GeoRef& ref);
  ~Polygons();
  Polygons(Polygons&&) noexcept;
  Polygons& operator=(Polygons&&) noexcept;

  /// The cells of a box whose centres lie in a polygon: 1 there, 0 elsewhere.
  Mask cells_in(const Box& box) const;

 private:
  struct Shapes;
  std::unique_ptr<Shapes> shapes_;
};

/// The lines and the outlines of polygons of all layers of a vector file, on the lattice of a
/// raster.
/// Throws IoError as Polygons does, and when the file has neither lines nor polygons.
Breaklines read_breaklines(const std::string& path, const GeoRef& ref, Size size);

/// A line in memory.
struct WorldLine {
  std::vector<double> x, y;
};

/// Breaklines in memory, on the lattice of a raster. `crs_wkt` is their coordinate system; "": that
/// of the raster.
/// Throws std::invalid_argument for a line whose x and y differ in number, that is not finite, or
/// that cannot be transformed.
Breaklines make_breaklines(const std::vector<WorldLine>& lines, const std::string& crs_wkt,
                           const GeoRef& ref, Size size);

/// Writes holes as polygons with their facts (hole_facts()) as attributes. The extension decides
/// the format (.gpkg, .geojson, .shp and others). The path holds what it held before or the whole
/// new file.
/// `known` is the mask in which the holes were found. Throws IoError.
void write_holes(const std::string& path, const std::vector<Hole>& holes, const Mask& known,
                 const GeoRef& ref, bool overwrite);

}  // namespace dem
