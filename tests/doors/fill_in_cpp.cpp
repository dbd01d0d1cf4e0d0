// Fills IN into OUT as README does: for test_every_door.py.

#include <exception>
#include <iostream>

#include "dem/fill.h"
#include "dem/io/rasters.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    const dem::DemFile file = dem::read_dem(argv[1]);
    const dem::HoleFill filled = dem::fill_holes(file.dem);
    dem::write_dem(argv[2], filled.dem, file.source);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
