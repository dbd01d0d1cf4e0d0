#include "dem/sketch.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "synthesis/paths.h"

namespace dem {
using namespace numeric;
using namespace synthesis;
namespace {

constexpr std::uint64_t stream_salt = 0x5a17;
constexpr float white = 0.98F;

}  // namespace

std::vector<Field> fields(SketchOptions& o) {
  std::vector<Field> list{
      {"low_m", o.low_m, {-20000, 20000}, "m", "height of black"},
      {"high_m", o.high_m, {-20000, 20000}, "m", "height of white, if it were not unknown"},
      {"salt", o.salt, {0, 1}, "", "share of the white cells that get random heights"},
  };
  for (auto& field : fields(o.mcmd)) list.push_back(std::move(field));
  return list;
}

Dem read_sketch(const Raster<float>& drawing, Spacing spacing, const SketchOptions& o) {
  check_options(o);
  check_map(drawing.size(), spacing, 1, "a sketch");
  Dem dem{Raster<float>(drawing.size()), Mask(drawing.size()), {}, spacing};
  for (int row = 0; row < drawing.rows(); ++row)
    for (int col = 0; col < drawing.cols(); ++col) {
      double grey = double(drawing(col, row));
      if (grey >= double(white)) {
        Sequence random(o.mcmd.seed, random_bits(stream_salt, 0, col, row));
        if (uniform(random) >= o.salt) continue;
        grey = uniform(random);
      }
      dem.z(col, row) = float(std::lerp(o.low_m, o.high_m, grey));
      dem.known(col, row) = 1;
    }
  const std::size_t known = count(dem.known);
  if (known == 0)
    throw std::invalid_argument("the drawing is all white; must have greys, which are heights");
  if (known == dem.known.cells().size())
    throw std::invalid_argument("the drawing has no white; must have unknown cells to fill");
  return dem;
}

Raster<float> generate_sketch(const Canvas& canvas, const Raster<float>& drawing,
                              const SketchOptions& o, const Run& run) {
  return fill_mcmd(read_sketch(drawing, canvas.spacing, o), o.mcmd, run);
}

}  // namespace dem
