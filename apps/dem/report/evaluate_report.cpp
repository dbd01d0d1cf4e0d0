#include "report/evaluate_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/breakdown.h"
#include "dem/evaluation.h"
#include "report/pictures.h"

namespace dem::app {
namespace {

Raster<float> difference(const Raster<float>& got, const Raster<float>& truth) {
  Raster<float> error = got;
  for (std::size_t i = 0; i < error.cells().size(); ++i) error.cells()[i] -= truth.cells()[i];
  return error;
}

/// A bound that all but `part` of |error| keep, as a round number.
double fitted_bound(const Raster<float>& error, const Mask& where, double part) {
  Raster<float> size = error;
  for (float& e : size.cells()) e = std::abs(e);
  const double parts[] = {part, 1};
  const auto found = quantiles(size, where, parts);
  const double bound = found[0] > 0 ? found[0] : found[1];
  return bound > 0 ? round_up(bound) : 1;
}

void add_pictures(Json& sections, const Compared& c, const Raster<float>& error) {
  const Size size = c.truth.size();
  const int k = cells_per_pixel(size, kPictureSide);
  const Spacing pixel{c.middle.dx_m * k, c.middle.dy_m * k};
  Means truth(size, k), got(size, k), errors(size, k);
  truth.add(0, c.truth, c.comparable);
  got.add(0, c.got, c.comparable);
  errors.add(0, error, c.comparable);

  const Raster<float> before = truth.surface();
  const HillshadeOptions light = report_light(before, pixel);
  const auto shaded = [&](const Raster<float>& z) {
    const Raster<std::uint8_t> shade = hillshade(z, pixel, light);
    Raster<Rgb> picture(z.size());
    for (int row = 0; row < z.rows(); ++row)
      for (int col = 0; col < z.cols(); ++col)
        picture(col, row) = mixed(kVoid, grey(shade(col, row)), truth.share(col, row));
    return picture;
  };
  sections.push_back(
      swipe_section("Truth and reconstruction", light_note(light) + pixel_note(k),
                    {"TRUTH", "Hillshade of the truth", shaded(before)},
                    {"GOT", "Hillshade of the reconstruction", shaded(got.surface())}, pixel));

  const double bound = fitted_bound(error, c.judged, 0.98);
  Raster<Rgb> picture(errors.size(), {214, 214, 210});
  for (int row = 0; row < picture.rows(); ++row)
    for (int col = 0; col < picture.cols(); ++col)
      if (errors.any(col, row))
        picture(col, row) =
            colour_at(kDifferenceRamp, 0.5 + double(errors.mean(col, row)) / (2 * bound));
  sections.push_back(map_section(
      "Error",
      "GOT − TRUTH: red is too high, blue too low. The scale holds 98 % of "
      "the scored cells.",
      {"", "Map of the errors", std::move(picture)}, pixel, kDifferenceRamp, -bound, bound, "m"));
}

Json histogram_of(const Compared& c, const Raster<float>& error) {
  constexpr int bins = 61;  // odd: one lies around 0
  const double bound = fitted_bound(error, c.judged, 0.99);
  const Histogram h = histogram(error, c.judged, -bound, bound, bins);
  const double deviation = std::sqrt(
      std::max(0.0, c.errors.rmse_m * c.errors.rmse_m - c.errors.bias_m * c.errors.bias_m));
  Series normal{"normal distribution of the same mean and deviation", {}, {}};
  normal.marks = false, normal.dashed = true;
  for (int i = 0; deviation > 0 && i <= 120; ++i) {
    const double x = -bound + 2 * bound * i / 120, t = (x - c.errors.bias_m) / deviation;
    normal.x.push_back(x);
    normal.y.push_back(double(c.errors.cells) * h.width() * std::exp(-t * t / 2) /
                       (deviation * std::sqrt(2 * std::numbers::pi)));
  }
  return histogram_section(
      "Errors",
      fmt::format("{} cells; {} lie beyond the axis, the largest error is {:.1f} m.",
                  grouped(c.errors.cells), grouped(h.below + h.above), c.errors.max_m),
      "error (GOT − TRUTH), m", h.low, h.high, h.cells, {normal});
}

Bars bars_of(const std::vector<ErrorClass>& classes, int digits) {
  Bars bars;
  std::vector<double> rmse, bias;
  for (const auto& k : classes) {
    if (k.cells == 0) continue;
    bars.classes.push_back(fmt::format("{:.{}f}–{:.{}f}", k.from, digits, k.to, digits));
    rmse.push_back(k.rmse_m);
    bias.push_back(k.bias_m);
    bars.counts.push_back(k.cells);
  }
  bars.y_label = "error, m";
  bars.series = {{"RMSE", rmse}, {"bias", bias}};
  return bars;
}

Json by_slope(const Compared& c, const Raster<float>& error, const Run& run) {
  const double bounds[] = {0, 2, 5, 10, 15, 20, 25, 30, 35, 40, 50, 90};
  Mask inner = c.judged;  // a slope needs eight neighbours
  for (int row = 0; row < inner.rows(); ++row)
    for (int col = 0; col < inner.cols(); ++col)
      if (row == 0 || col == 0 || row == inner.rows() - 1 || col == inner.cols() - 1)
        inner(col, row) = 0;
  Bars bars = bars_of(errors_by(error, inner, slope_deg(c.truth, c.spacing, run), bounds), 0);
  if (bars.classes.empty()) return {};
  bars.title = "Error by slope";
  bars.note = "Bias is the mean error. Below: how many cells each class has.";
  bars.x_label = "slope of TRUTH, degrees";
  return bars_section(bars);
}

Json by_distance(const Compared& c, const Raster<float>& error) {
  // Classes of doubling width; the first are those beside a known cell.
  const double cell = std::sqrt(c.middle.dx_m * c.middle.dy_m);
  std::vector<double> bounds{0.25 * cell};
  const Raster<float> distance = distance_to_known(c.known, c.middle);
  const double farthest = double(std::ranges::max(distance.cells()));
  for (double cells = 1.5; bounds.back() <= farthest; cells *= 2) bounds.push_back(cells * cell);
  if (bounds.size() < 2) bounds.push_back(1.5 * cell);
  Bars bars = bars_of(errors_by(error, c.judged, distance, bounds), cell < 4 ? 1 : 0);
  bars.title = "Error by distance to data";
  bars.note = fmt::format("Bias is the mean error; a cell is about {:.3g} m wide.", cell);
  bars.x_label = "distance to the nearest known cell, m";
  return bars_section(bars);
}

Json calibration_section(const Compared& c, const Raster<float>& error) {
  // Twenty classes with equally many cells.
  Mask told = c.judged;
  for (std::size_t i = 0; i < told.cells().size(); ++i)
    if (!(c.sigma.cells()[i] > 0)) told.cells()[i] = 0;
  std::vector<double> parts;
  for (int i = 0; i <= 20; ++i) parts.push_back(i / 20.0);
  std::vector<double> bounds = quantiles(c.sigma, told, parts);
  bounds.back() = std::nextafter(bounds.back() * (1 + 1e-6), INFINITY);
  bounds.erase(std::unique(bounds.begin(), bounds.end()), bounds.end());

  Series found{"found", {}, {}}, right{"as foretold", {}, {}};
  right.marks = false, right.dashed = true;
  for (const auto& k : errors_by(error, told, c.sigma, bounds)) {
    if (k.cells == 0 || !(k.rmse_m > 0)) continue;
    found.x.push_back(k.by_rms);
    found.y.push_back(k.rmse_m);
  }
  if (found.x.empty()) return {};
  const auto [low, high] = std::ranges::minmax(found.x);
  right.x = right.y = {low, high};
  const Calibration all = calibration(c.truth, c.got, c.judged, c.sigma);
  return lines_section(
      {"Calibration of sigma",
       {"foretold standard deviation, m", true},
       {"RMSE, m", true},
       {found, right}},
      fmt::format("A point is a twentieth of the cells. Above the line errors are larger than "
                  "foretold. Within 1, 2, 3 sigma lie {:.1f}, {:.1f}, {:.1f} % of the errors "
                  "(normal distribution: 68.3, 95.4, 99.7 %).",
                  100 * all.within_1, 100 * all.within_2, 100 * all.within_3));
}

}  // namespace

Json error_sections(const Compared& c, const std::vector<SpectrumBin>& truth,
                    const std::vector<SpectrumBin>& got, const Run& run) {
  const Raster<float> error = difference(c.got, c.truth);
  Json sections = Json::array();
  const auto add = [&](Json section) {
    if (!section.is_null()) sections.push_back(std::move(section));
  };
  run.report(0, "report");
  add_pictures(sections, c, error);
  run.report(0.4, "report");
  add(histogram_of(c, error));
  add(by_slope(c, error, run.part(0.5, 0.7)));
  if (!c.known.empty()) add(by_distance(c, error));
  run.report(0.9, "report");
  if (!c.sigma.empty()) add(calibration_section(c, error));
  add(spectrum_section({{"TRUTH", truth}, {"GOT", got}},
                       "Where GOT lies below TRUTH it is too smooth, above it too rough."));
  return sections;
}

}  // namespace dem::app
