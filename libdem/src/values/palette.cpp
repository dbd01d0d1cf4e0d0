#include "dem/palette.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace dem {
namespace {

struct Stop {
  double height;
  Colour colour;
};

// Each palette runs from dark to light. Where hues change they go along blue and yellow rather than
// red and green, the pair that most people with a colour deficiency mix up.
constexpr Stop kAtlas[] = {{0.00, {84, 133, 121}},  {0.18, {122, 158, 124}},
                           {0.38, {172, 183, 133}}, {0.58, {212, 198, 150}},
                           {0.78, {228, 213, 188}}, {1.00, {250, 248, 244}}};
constexpr Stop kAlpine[] = {{0.00, {52, 76, 58}},    {0.25, {84, 104, 72}},
                            {0.45, {124, 127, 98}},  {0.62, {152, 147, 134}},
                            {0.78, {190, 190, 190}}, {1.00, {252, 253, 255}}};
constexpr Stop kDesert[] = {{0.00, {105, 66, 56}},
                            {0.25, {150, 96, 70}},
                            {0.50, {196, 140, 95}},
                            {0.75, {230, 189, 140}},
                            {1.00, {252, 241, 219}}};
constexpr Stop kDusk[] = {{0.00, {38, 50, 92}},
                          {0.25, {74, 84, 118}},
                          {0.50, {122, 120, 128}},
                          {0.75, {190, 168, 124}},
                          {1.00, {250, 228, 148}}};
constexpr Stop kPaper[] = {{0.00, {222, 220, 214}}, {1.00, {250, 249, 246}}};
constexpr Stop kSea[] = {{0.00, {128, 174, 198}}, {0.15, {98, 148, 182}}, {1.00, {30, 62, 104}}};

std::span<const Stop> stops(Palette palette) {
  switch (palette) {
    case Palette::atlas:
      return kAtlas;
    case Palette::alpine:
      return kAlpine;
    case Palette::desert:
      return kDesert;
    case Palette::dusk:
      return kDusk;
    case Palette::paper:
      return kPaper;
  }
  return kAtlas;
}

Colour between(std::span<const Stop> stops, double height) {
  if (!(height > 0)) return stops.front().colour;
  std::size_t i = 1;
  while (i + 1 < stops.size() && height > stops[i].height) ++i;
  const Stop &low = stops[i - 1], &high = stops[i];
  const double t = std::min(1.0, (height - low.height) / (high.height - low.height));
  Colour colour{};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = low.colour[c] + t * (high.colour[c] - low.colour[c]);
  return colour;
}

}  // namespace

const std::vector<PaletteInfo>& palettes() {
  static const std::vector<PaletteInfo> all{
      {"atlas", "blue-green lowlands, sand, white heights: a wall map"},
      {"alpine", "forest, rock, snow"},
      {"desert", "red earth to pale sand"},
      {"dusk", "slate blue to gold: safe for every colour vision"},
      {"paper", "nearly white: the light alone draws the ground"}};
  return all;
}

std::vector<std::string> palette_names() {
  std::vector<std::string> names;
  for (const auto& palette : palettes()) names.push_back(palette.name);
  return names;
}

Colour palette_colour(Palette palette, double height) { return between(stops(palette), height); }

Colour ColourScale::operator()(double height_m) const {
  if (sea && height_m <= 0) return between(kSea, low_m < 0 ? height_m / low_m : 0);
  const double from = sea ? std::max(0.0, low_m) : low_m;
  return palette_colour(palette, high_m > from ? (height_m - from) / (high_m - from) : 0);
}

}  // namespace dem
