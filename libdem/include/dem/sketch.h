#pragma once
// MCMD as a modelling tool [belhadj2007, section 4]: terrain around a drawing or an L-system.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "dem/canvas.h"
#include "dem/dem.h"
#include "dem/fields.h"
#include "dem/mcmd.h"
#include "dem/run.h"

namespace dem {

/// Options of fill_sketch and read_sketch.
struct SketchOptions {
  double low_m = 0;
  double high_m = 255;
  double salt = 0;
  McmdOptions mcmd{};  ///< mcmd.seed is also the seed of the salt
};
std::vector<Field> fields(SketchOptions& options);

/// Reads a drawing. White (from 0.98) is unknown. Greys are heights, from low_m (black) to high_m
/// (white). A share `salt` of the white cells gets random heights ("salt and pepper").
/// Method: [belhadj2007] section 4, figures 12 and 13.
/// Throws: std::invalid_argument when no cell is known, or all cells are; Cancelled.
Dem read_sketch(const Raster<float>& drawing, Spacing spacing, const SketchOptions& options = {});

/// Fills a drawing by MCMD. It gives, costs and throws the same as read_sketch and fill_mcmd.
Raster<float> generate_sketch(const Canvas& canvas, const Raster<float>& drawing,
                              const SketchOptions& options = {}, const Run& run = {});

/// A bracketed L-system, and how a turtle reads it. F draws a line. + and - turn by `angle` (!
/// swaps them). @0.5 shortens the lines. [ and ] save and restore the state.
/// The default is that of [belhadj2007], footnote 2.
struct LSystem {
  std::string axiom = "+++++++X";
  std::vector<std::pair<char, std::string>> rules{{'X', "F[@.5++++++X]-F[@.4-----!X]@.6X"}};
  double angle = 1.0 / 50;  ///< in turns; pi / 25 in the paper
  double start = 0.25;      ///< in turns, from east toward north; pi / 2 in the paper
};

/// Options of draw_lsystem and generate_lsystem.
struct LSystemOptions {
  int rewrites = 12;
  double low_m = 60;
  double high_m = 255;
  double margin = 0.1;
  McmdOptions mcmd{.I = 1.1, .I_bu = 10, .H = 0.48, .rs = 0.5};
};
std::vector<Field> fields(LSystemOptions& options);

/// Draws the path of an L-system after `rewrites` rewrites, as large as it fits within `margin`.
/// The cells of the path are the known cells of the DEM.
/// Heights go from high_m for lines of full length to low_m for the finest. Where lines cross, the
/// higher one counts. Branches finer than a third of a cell are left out.
/// Throws: std::invalid_argument for a system that draws nothing or whose brackets do not match.
Dem draw_lsystem(Size size, Spacing spacing, const LSystem& system = {},
                 const LSystemOptions& options = {});

/// MCMD around the path of the paper's L-system.
/// Method:   [belhadj2007] figure 11 (b) and footnote 2.
Raster<float> generate_lsystem(const Canvas& canvas, const LSystemOptions& options = {},
                               const Run& run = {});

}  // namespace dem
