// Writes a DEM with one hole, reads it back and fills it by each method there is.

#include <cstdio>
#include <string>

#include "dem/io/methods.h"
#include "dem/io/rasters.h"

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const std::string path = argv[1];

  dem::Dem dem{.z = dem::Raster<float>({4, 3}, 250), .known = dem::Mask({4, 3}, 1)};
  dem.known(1, 1) = 0;
  dem::write_dem(path, dem, {}, {.overwrite = true});

  const dem::Dem read = dem::read_dem(path).dem;
  bool right = read.known == dem.known;
  for (const auto& method : dem::all_fill_methods()) {
    const dem::Filled filled = method.fill(read, {}, {});
    std::printf("%-10s %7.2f\n", method.name.c_str(), double(filled.z(1, 1)));
    right = right && filled.z(0, 0) == 250;
  }
  return right ? 0 : 1;
}
