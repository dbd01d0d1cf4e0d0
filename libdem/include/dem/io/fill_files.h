#pragma once
// The files that a fill may know besides the raster.

#include <string>
#include <vector>

#include "dem/fill.h"

namespace dem {

struct FillFiles {
  std::vector<std::string> aux{};  ///< DEMs to fill over, in any coordinate system
  std::string water{};             ///< polygons of lakes
  std::string region{};            ///< polygons: only voids with a cell in them are filled
};

/// Opens the files; they are read box by box on the lattice of `ref`.
/// Throws IoError when a file cannot be read or does not fit the raster.
FillLayers open_layers(const FillFiles& files, const GeoRef& ref);

}  // namespace dem
