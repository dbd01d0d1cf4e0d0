#pragma once
// Colours for heights. In each palette higher ground is lighter. Heights can therefore be compared
// by lightness alone, in grey print and with any colour vision.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dem {

using Rgb = std::array<std::uint8_t, 3>;

/// Red, green and blue as sRGB, 0 to 255, before they are rounded.
using Colour = std::array<double, 3>;

enum class Palette { atlas, alpine, desert, dusk, paper };

/// Name and one line of description of each palette, in the order of the enumerators.
struct PaletteInfo {
  std::string name, doc;
};
const std::vector<PaletteInfo>& palettes();
std::vector<std::string> palette_names();

/// The colour of ground from the lowest (0) to the highest (1). Values outside have the colour of
/// the nearest end.
Colour palette_colour(Palette palette, double height);

/// Colours for heights in metres.
struct ColourScale {
  Palette palette = Palette::atlas;
  double low_m = 0, high_m = 1;  ///< the palette's ends
  bool sea = false;  ///< heights at or below 0 are water, the deeper the darker; land starts at 0

  Colour operator()(double height_m) const;
};

}  // namespace dem
