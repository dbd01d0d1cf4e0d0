#include "report/pictures.h"

#include <algorithm>
#include <cmath>

#include "dem/breakdown.h"
#include "dem/evaluate.h"
#include "dem/io/image.h"
#include "dem/mcmd.h"

namespace dem::app {

const Ramp kDifferenceRamp{{20, 62, 120},   {62, 128, 188}, {158, 200, 224}, {246, 245, 240},
                           {240, 186, 150}, {206, 102, 66}, {128, 30, 32}};
const Ramp kSigmaRamp{
    {252, 246, 214}, {246, 200, 120}, {228, 134, 80}, {170, 60, 92}, {72, 22, 92}};

namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (j < n ? std::uint8_t(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) text += j <= n ? digits[group >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

std::string css(Rgb c) { return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]); }

/// Shaded ground as JPEG, which takes a third of PNG's bytes; small pictures and flat colours as
/// PNG.
Json image(const Picture& picture, bool shaded) {
  const bool large = picture.pixels.size().cells() > 256 * 256;
  return {{"label", picture.label},
          {"alt", picture.alt},
          {"src", data_uri(picture.pixels, shaded && large ? "jpg" : "png")},
          {"width", picture.pixels.cols()},
          {"height", picture.pixels.rows()}};
}

/// Width by height on the ground.
double aspect(Size size, Spacing pixel) {
  return size.cols * pixel.dx_m / (size.rows * pixel.dy_m);
}

Json map(std::string title, std::string note, const Picture& picture, Spacing pixel) {
  return {{"kind", "map"},
          {"title", std::move(title)},
          {"note", std::move(note)},
          {"aspect", aspect(picture.pixels.size(), pixel)},
          {"picture", image(picture, false)}};
}

}  // namespace

int cells_per_pixel(Size size, int side) {
  return std::max(1, (std::max(size.cols, size.rows) + side - 1) / side);
}

Shares::Shares(Size size, int k)
    : full_(size), k_(k), count_({(size.cols + k - 1) / k, (size.rows + k - 1) / k}) {}

void Shares::add(int first_row, const Raster<std::uint8_t>& kinds, std::uint8_t kind) {
  for (int row = 0; row < kinds.rows(); ++row) {
    const auto cells = kinds.row(row);
    for (int begin = 0; begin < kinds.cols(); begin += k_) {
      const auto square =
          cells.subspan(std::size_t(begin), std::size_t(std::min(k_, kinds.cols() - begin)));
      count_(begin / k_, (first_row + row) / k_) += float(std::ranges::count(square, kind));
    }
  }
}

double Shares::share(int col, int row) const {
  const int cols = std::min(k_, full_.cols - col * k_), rows = std::min(k_, full_.rows - row * k_);
  return double(count_(col, row)) / double(cols * rows);
}

void Means::add(int first_row, const Raster<float>& values, const Mask& where) {
  where_.add(first_row, where, 1);
  for (int row = 0; row < values.rows(); ++row)
    for (int begin = 0; begin < values.cols(); begin += k_) {
      double sum = 0;
      for (int col = begin; col < std::min(begin + k_, values.cols()); ++col)
        if (where(col, row)) sum += double(values(col, row));
      sum_(begin / k_, (first_row + row) / k_) += sum;
    }
}

Raster<float> Means::surface() const {
  Dem dem{Raster<float>(size()), Mask(size()), {}, {}};
  for (int row = 0; row < size().rows; ++row)
    for (int col = 0; col < size().cols; ++col)
      if (any(col, row)) {
        dem.z(col, row) = mean(col, row);
        dem.known(col, row) = 1;
      }
  const std::size_t known = count(dem.known);
  return known == 0 || known == size().cells() ? dem.z : fill_mcmd(dem);
}

HillshadeOptions report_light(const Raster<float>& z, Spacing spacing) {
  // So that one cell in ten is steeper than 30 degrees, in the picture.
  constexpr double kSteep = 0.6;
  HillshadeOptions light;
  const double parts[] = {0.9};
  const Raster<float> slope = slope_deg(z, std::span(&spacing, 1));
  const double steep = std::tan(quantiles(slope, Mask(z.size(), 1), parts)[0] * 3.14159265 / 180);
  if (steep > 0) light.exaggeration = std::clamp(std::round(kSteep / steep), 1.0, 20.0);
  return light;
}

std::string light_note(const HillshadeOptions& light) {
  return light.exaggeration > 1
             ? fmt::format("Light from the north-west, heights times {:.0f}. ", light.exaggeration)
             : "Light from the north-west. ";
}

std::string pixel_note(int k) {
  return k == 1 ? "A pixel is a cell." : fmt::format("A pixel is the mean of {0} x {0} cells.", k);
}

Rgb mixed(Rgb a, Rgb b, double part_of_b) {
  Rgb c{};
  for (std::size_t i = 0; i < 3; ++i)
    c[i] = std::uint8_t(std::lround(a[i] + part_of_b * (double(b[i]) - a[i])));
  return c;
}

Rgb colour_at(const Ramp& ramp, double t) {
  const double at = std::clamp(t, 0.0, 1.0) * double(ramp.size() - 1);
  const auto i = std::min(std::size_t(at), ramp.size() - 2);
  return mixed(ramp[i], ramp[i + 1], at - double(i));
}

double round_up(double x) {
  const double unit = std::pow(10, std::floor(std::log10(x)));
  for (const double digit : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (x <= digit * unit * (1 + 1e-9)) return digit * unit;
  return 10 * unit;
}

std::string data_uri(const Raster<Rgb>& picture, std::string_view format) {
  return fmt::format("data:image/{};base64,{}", format == "jpg" ? "jpeg" : format,
                     base64(encode_image(picture, format)));
}

Json swipe_section(std::string title, std::string note, const Picture& before, const Picture& after,
                   Spacing pixel) {
  return {{"kind", "swipe"},
          {"title", std::move(title)},
          {"note", std::move(note)},
          {"aspect", aspect(before.pixels.size(), pixel)},
          {"before", image(before, true)},
          {"after", image(after, true)}};
}

Json map_section(std::string title, std::string note, const Picture& picture, Spacing pixel,
                 const std::vector<KeyEntry>& key) {
  Json json = map(std::move(title), std::move(note), picture, pixel);
  json["key"] = Json::array();
  for (const auto& entry : key) json["key"].push_back({entry.name, css(entry.colour)});
  return json;
}

Json map_section(std::string title, std::string note, const Picture& picture, Spacing pixel,
                 const Ramp& ramp, double low, double high, std::string unit) {
  Json json = map(std::move(title), std::move(note), picture, pixel);
  Json colours = Json::array();
  for (const Rgb& c : ramp) colours.push_back(css(c));
  json["scale"] = {{"colours", colours}, {"low", low}, {"high", high}, {"unit", std::move(unit)}};
  return json;
}

Json picture_cell(const std::vector<Picture>& pictures, Spacing pixel) {
  Json cell{{"pictures", Json::array()}};
  for (const auto& p : pictures) {
    Json json = image(p, true);
    json["aspect"] = aspect(p.pixels.size(), pixel);
    cell["pictures"].push_back(std::move(json));
  }
  return cell;
}

}  // namespace dem::app
