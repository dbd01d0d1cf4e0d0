#pragma once
// Pictures for a report: surfaces shrunk to the size of a screen, shaded, coloured, as data URIs.

#include <functional>
#include <string>
#include <vector>

#include "common.h"
#include "dem/draw.h"
#include "dem/holes.h"

namespace dem::app {

/// Pixels on the longer side of a picture, at most: an SRTM tile of 1201 cells is not shrunk.
inline constexpr int kPictureSide = 1300;

/// Cells on the side of a pixel, so that a picture of `size` has at most `side` pixels on a side.
int cells_per_pixel(Size size, int side);

/// How much of each square of k x k cells is of one kind, from rows that pass in order.
class Shares {
 public:
  Shares() = default;
  Shares(Size size, int k);

  /// Rows from `first_row` on; cells of this kind count.
  void add(int first_row, const Raster<std::uint8_t>& kinds, std::uint8_t kind);

  Size size() const { return count_.size(); }
  bool any(int col, int row) const { return count_(col, row) > 0; }
  float count(int col, int row) const { return count_(col, row); }
  double share(int col, int row) const;

 private:
  Size full_;
  int k_ = 1;
  Raster<float> count_;
};

/// Means over squares of k x k cells.
class Means {
 public:
  Means() = default;
  Means(Size size, int k) : k_(k), where_(size, k), sum_(where_.size()) {}

  /// Rows from `first_row` on; cells where `where` is 1 count.
  void add(int first_row, const Raster<float>& values, const Mask& where);

  Size size() const { return where_.size(); }
  bool any(int col, int row) const { return where_.any(col, row); }
  double share(int col, int row) const { return where_.share(col, row); }
  float mean(int col, int row) const { return float(sum_(col, row) / where_.count(col, row)); }

  /// The means; squares without any get heights from those around them.
  Raster<float> surface() const;

 private:
  int k_ = 1;
  Shares where_;
  Raster<double> sum_;
};

/// The light of a report's pictures: heights are exaggerated where the land is flat.
HillshadeOptions report_light(const Raster<float>& z, Spacing spacing);

/// How pictures were lit and shrunk, in words.
std::string light_note(const HillshadeOptions& light);
std::string pixel_note(int cells_per_pixel);

/// Colours from low to high.
using Ramp = std::vector<Rgb>;
extern const Ramp kDifferenceRamp;         ///< blue, white, red
extern const Ramp kSigmaRamp;              ///< pale to dark
inline constexpr Rgb kVoid{232, 120, 92};  ///< cells without a height

Rgb colour_at(const Ramp& ramp, double t);
Rgb mixed(Rgb a, Rgb b, double part_of_b);
inline Rgb grey(std::uint8_t g) { return {g, g, g}; }

/// The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 ... times a power of ten that is >= x > 0.
double round_up(double x);

std::string data_uri(const Raster<Rgb>& picture, std::string_view format);

struct Picture {
  std::string label, alt;
  Raster<Rgb> pixels;
};

/// Two pictures of one place, one drawn over the other. `pixel`: its size on the ground.
Json swipe_section(std::string title, std::string note, const Picture& before, const Picture& after,
                   Spacing pixel);

/// A picture with a key of colours.
struct KeyEntry {
  std::string name;
  Rgb colour;
};
Json map_section(std::string title, std::string note, const Picture& picture, Spacing pixel,
                 const std::vector<KeyEntry>& key);

/// A picture with a scale of colours from `low` to `high`.
Json map_section(std::string title, std::string note, const Picture& picture, Spacing pixel,
                 const Ramp& ramp, double low, double high, std::string unit);

/// Small pictures in a cell of a table.
Json picture_cell(const std::vector<Picture>& pictures, Spacing pixel);

}  // namespace dem::app
