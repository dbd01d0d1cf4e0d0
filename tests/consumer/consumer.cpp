// Fills a small DEM and prints it: what a program needs of libdem when it has its own files.

#include <cstdio>

#include "dem/mcmd.h"

int main() {
  dem::Dem dem{.z = dem::Raster<float>({5, 5}), .known = dem::Mask({5, 5})};
  dem.z(0, 0) = 100;
  dem.z(4, 4) = 200;
  dem.known(0, 0) = dem.known(4, 4) = 1;

  const dem::Raster<float> filled = dem::fill_mcmd(dem);

  for (int row = 0; row < filled.rows(); ++row) {
    for (float z : filled.row(row)) std::printf("%7.2f", double(z));
    std::printf("\n");
  }
  return filled(0, 0) == 100 && filled(4, 4) == 200 ? 0 : 1;
}
