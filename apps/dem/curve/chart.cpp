#include "curve/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace dem::app {
namespace {

// Okabe and Ito's colours without the yellow, then grey.
constexpr const char* kColours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                    "#E69F00", "#56B4E9", "#000000", "#777777"};
constexpr int kMarks = 8;

constexpr double kPlotWidth = 470, kPlotHeight = 380, kLeft = 74, kRight = 175, kTop = 84,
                 kBottom = 84, kPanelWidth = kLeft + kPlotWidth + kRight;

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string text_at(double x, double y, const std::string& text, std::string_view style) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", x, y, style, escaped(text));
}

/// Maps values of one axis to pixels from `from` (smallest) to `to` (largest).
struct Scale {
  double low, high, from, to;
  bool log;

  double operator()(double v) const {
    const double t = log ? std::log(v / low) / std::log(high / low) : (v - low) / (high - low);
    return from + t * (to - from);
  }
};

/// 1, 2 or 5 times a power of ten, so that about five steps make `span`.
double round_step(double span) {
  const double raw = span / 5, power = std::pow(10, std::floor(std::log10(raw)));
  for (double m : {1.0, 2.0, 5.0})
    if (raw <= m * power) return m * power;
  return 10 * power;
}

std::vector<double> ticks_of(const Scale& s) {
  std::vector<double> ticks;
  if (!s.log) {
    const double step = round_step(s.high - s.low);
    for (double i = std::ceil(s.low / step); i * step <= s.high + 1e-9 * step; ++i)
      ticks.push_back(i * step);
    return ticks;
  }
  const bool many = s.high / s.low > 3000;  // then decades alone
  for (int e = int(std::floor(std::log10(s.low))); std::pow(10, e) <= s.high * 1.001; ++e)
    for (double m : {1.0, 2.0, 5.0})
      if (const double v = m * std::pow(10, e);
          (m == 1 || !many) && v >= s.low * 0.999 && v <= s.high * 1.001)
        ticks.push_back(v);
  return ticks;
}

Scale fit(const Panel& panel, bool vertical, double from, double to) {
  const Axis& axis = vertical ? panel.y : panel.x;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& s : panel.series)
    for (double v : vertical ? s.y : s.x) low = std::min(low, v), high = std::max(high, v);
  if (!(low <= high)) low = high = 1;
  if (axis.log && vertical) {
    low /= 1.15, high *= 1.15;
  } else if (!axis.log) {
    const double step = round_step(std::max(high - low, 1e-9));
    if (vertical) low = std::floor(low / step) * step, high = std::ceil(high / step) * step;
  }
  if (low == high) low = axis.log ? low / 2 : low - 1, high = axis.log ? high * 2 : high + 1;
  if (axis.reversed) std::swap(from, to);
  return {low, high, from, to, axis.log};
}

std::string mark(int kind, double x, double y, std::string_view colour) {
  const std::string at =
      fmt::format("transform=\"translate({:.1f} {:.1f})\" fill=\"{}\"", x, y, colour);
  switch (kind % kMarks) {
    case 0:
      return fmt::format("<circle {} r=\"3.4\"/>\n", at);
    case 1:
      return fmt::format("<rect {} x=\"-3\" y=\"-3\" width=\"6\" height=\"6\"/>\n", at);
    case 2:
      return fmt::format("<path {} d=\"M0 -4.2L4 3.2H-4Z\"/>\n", at);
    case 3:
      return fmt::format("<path {} d=\"M0 4.2L4 -3.2H-4Z\"/>\n", at);
    case 4:
      return fmt::format("<path {} d=\"M0 -4.4L4.4 0L0 4.4L-4.4 0Z\"/>\n", at);
    case 5:
      return fmt::format(
          "<path {} d=\"M-1.2 -4h2.4v2.8h2.8v2.4h-2.8v2.8h-2.4v-2.8h-2.8v-2.4h2.8z\"/>\n", at);
    case 6:
      return fmt::format(
          "<path {} stroke=\"{}\" stroke-width=\"1.8\" d=\"M-3 -3L3 3M-3 3L3 -3\"/>\n", at, colour);
    default:
      return fmt::format("<circle {} r=\"3.4\" style=\"fill:#fff;stroke:{};stroke-width:1.6\"/>\n",
                         at, colour);
  }
}

/// Heights of the names at the right ends: near their lines, at least 15 pixels apart.
std::vector<double> spread(std::vector<double> want, double top, double bottom) {
  constexpr double apart = 15;
  std::vector<std::size_t> order(want.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return want[i]; });
  double free = top;
  for (auto i : order) want[i] = std::max(want[i], free), free = want[i] + apart;
  double limit = bottom;
  for (auto i = order.rbegin(); i != order.rend(); ++i)
    want[*i] = std::min(want[*i], limit), limit = want[*i] - apart;
  return want;
}

std::string frame(const Panel& panel, const Scale& x, const Scale& y) {
  std::string svg = text_at(kLeft, kTop - 14, panel.title, "class=\"panel\"");
  for (double v : panel.y.ticks.empty() ? ticks_of(y) : panel.y.ticks) {
    svg += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>\n", kLeft, y(v),
                       kPlotWidth);
    svg += text_at(kLeft - 8, y(v) + 4, fmt::format("{:.6g}", v), "text-anchor=\"end\"");
  }
  for (double v : panel.x.ticks.empty() ? ticks_of(x) : panel.x.ticks) {
    svg += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}v{:.1f}\"/>\n", x(v), kTop,
                       kPlotHeight);
    svg +=
        text_at(x(v), kTop + kPlotHeight + 18, fmt::format("{:.6g}", v), "text-anchor=\"middle\"");
  }
  svg += fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}v{:.1f}h{:.1f}\"/>\n", kLeft, kTop,
                     kPlotHeight, kPlotWidth);
  svg += text_at(kLeft + kPlotWidth / 2, kTop + kPlotHeight + 40, panel.x.label,
                 "text-anchor=\"middle\"");
  svg += fmt::format(
      "<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      18.0, kTop + kPlotHeight / 2, escaped(panel.y.label));
  return svg;
}

std::string draw_panel(const Panel& panel) {
  const Scale x = fit(panel, false, kLeft, kLeft + kPlotWidth);
  const Scale y = fit(panel, true, kTop + kPlotHeight, kTop);
  std::string svg = frame(panel, x, y);

  for (const double level : panel.levels)
    if (level >= y.low && level <= y.high)
      svg += fmt::format("<path class=\"level\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>\n", kLeft, y(level),
                         kPlotWidth);

  std::vector<double> ends, tips;
  for (const auto& s : panel.series) {
    std::size_t last = 0;  // the rightmost point
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (x(s.x[i]) >= x(s.x[last])) last = i;
    ends.push_back(s.y.empty() ? kTop : y(s.y[last]));
    tips.push_back(s.x.empty() ? kLeft + kPlotWidth : x(s.x[last]));
  }
  const auto names = spread(ends, kTop + 6, kTop + kPlotHeight);
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const auto& s = panel.series[i];
    const std::string_view colour = kColours[i % std::size(kColours)];
    std::string points;
    for (std::size_t j = 0; j < s.x.size(); ++j)
      points += fmt::format("{:.1f},{:.1f} ", x(s.x[j]), y(s.y[j]));
    if (s.line)
      svg += fmt::format(
          "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"{} points=\"{}\"/>\n", colour,
          s.dashed ? " stroke-dasharray=\"5 4\"" : "", points);
    for (std::size_t j = 0; s.marks && j < s.x.size(); ++j)
      svg += mark(int(i), x(s.x[j]), y(s.y[j]), colour);
    const double right = kLeft + kPlotWidth;
    svg += fmt::format(
        "<path fill=\"none\" stroke=\"{}\" stroke-opacity=\"0.5\" d=\"M{:.1f} {:.1f}L{:.1f} "
        "{:.1f}\"/>\n",
        colour, tips[i] + 5, ends[i], right + 18, names[i]);
    if (s.marks) svg += mark(int(i), right + 24, names[i], colour);
    svg += text_at(right + 32, names[i] + 4, s.name, fmt::format("style=\"fill:{}\"", colour));
  }
  return svg;
}

}  // namespace

std::string svg_chart(const std::string& title, const std::string& note,
                      const std::vector<Panel>& panels) {
  const double width = kPanelWidth * double(panels.size()), height = kTop + kPlotHeight + kBottom;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
      "{1}\">\n"
      "<style>text{{font:13px 'DejaVu Sans',Helvetica,Arial,sans-serif;fill:#222}}"
      ".title{{font-size:17px;font-weight:bold}}.panel{{font-size:14px;font-weight:bold}}"
      ".note{{font-size:11.5px;fill:#555}}.grid{{stroke:#e4e4e4;fill:none}}.axis{{stroke:#444;fill:"
      "none}}.level{{stroke:#888;stroke-width:1.2;stroke-dasharray:2 4}}"
      "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width, height);
  svg += text_at(kLeft, 32, title, "class=\"title\"");
  svg += text_at(kLeft, height - 16, note, "class=\"note\"");
  for (std::size_t i = 0; i < panels.size(); ++i)
    svg += fmt::format("<g transform=\"translate({} 0)\">\n{}</g>\n", kPanelWidth * double(i),
                       draw_panel(panels[i]));
  return svg + "</svg>\n";
}

}  // namespace dem::app
