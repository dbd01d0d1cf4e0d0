#pragma once
// What the three reproductions share.

#include <optional>

#include "dem/draw.h"
#include "dem/mcmd.h"
#include "verbs.h"

namespace dem::app {

struct ReproduceOptions {
  std::string what, dir, tile, data;
  int repeats = 3;
};

/// A number of the paper beside ours.
struct Comparison {
  std::string what, unit;
  std::optional<double> paper;
  double ours = 0;
};

/// What a reproduction tells.
struct Findings {
  std::vector<std::string> notes;  ///< what differs from the paper, a line each
  std::vector<Comparison> numbers;
  std::vector<std::string> pictures;
  std::vector<std::function<void()>> writers;  ///< write the pictures, once all work is done
  std::string table;                           ///< more for a person, after the numbers
  Json extra = Json::object();
  std::vector<std::string> failures;  ///< checks that failed
};

Findings reproduce_mount_washington(const ReproduceOptions& o, const OutputFolder& folder,
                                    Shell& shell);
Findings reproduce_n36e008(const ReproduceOptions& o, const OutputFolder& folder, Shell& shell);
Findings reproduce_figures(const ReproduceOptions& o, const OutputFolder& folder, Shell& shell);

/// The first of `names` in --data, else $DEM_TESTDATA, else ../shared/data; "" if none is there.
std::string find_data(const ReproduceOptions& o, const std::vector<std::string>& names);

/// Reads a tile; "N42E001.void.hgt" is understood to be the tile N42E001.
DemFile read_tile(const std::string& path, const Run& run);

/// The size x size cells (fewer, when the DEM has fewer) around its highest cell, inside the DEM.
Dem window_around_summit(const Dem& dem, int size);

/// Options of MCMD as `name` ("mcmd", "mcmd:paper") stands for them in the method table.
McmdOptions mcmd_options(const std::string& name);

/// Adds a hillshade; known cells alone, white elsewhere, when `known` is given.
void draw(Findings& findings, const std::string& path, const Raster<float>& z, Spacing spacing,
          bool overwrite, const Mask& known = {});

}  // namespace dem::app
