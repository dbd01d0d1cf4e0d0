#pragma once
// Polygons of vector files, in and out, and breaklines.

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
  /// All polygons of all layers, brought into the raster's coordinates.
  /// Throws IoError when the file cannot be read, holds no polygon, or says no coordinate system
  /// where the raster has one.
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

/// The lines and the outlines of polygons of all layers of a vector file, on a raster's lattice.
/// Throws IoError as Polygons, and when there is neither.
Breaklines read_breaklines(const std::string& path, const GeoRef& ref, Size size);

/// Writes holes as polygons with their facts (hole_facts()) as attributes; the format follows the
/// extension (.gpkg, .geojson, .shp ...). The path holds what it held before or the whole new file.
/// `known`: the mask that the holes were found in. Throws IoError.
void write_holes(const std::string& path, const std::vector<Hole>& holes, const Mask& known,
                 const GeoRef& ref, bool overwrite);

}  // namespace dem
