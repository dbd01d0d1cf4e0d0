#include "report/page.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <string_view>

namespace dem::app {

extern const std::string_view report_page;  // made by page.cmake

namespace {

Json pairs(const Texts& texts) {
  Json rows = Json::array();
  for (const auto& [what, value] : texts) rows.push_back({what, value});
  return rows;
}

Json axis(const Axis& a) {
  return {{"label", a.label}, {"log", a.log}, {"reversed", a.reversed}, {"ticks", a.ticks}};
}

Json line(const Series& s) {
  return {{"name", s.name}, {"x", s.x},         {"y", s.y},
          {"line", s.line}, {"marks", s.marks}, {"dashed", s.dashed}};
}

Json section(const char* kind, std::string title, std::string note) {
  return {{"kind", kind}, {"title", std::move(title)}, {"note", std::move(note)}};
}

std::string seconds(double s) { return fmt::format("{:.3f} s", s); }

}  // namespace

std::string name_of(const std::string& path) {
  const std::filesystem::path whole(path);
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

void add_report_option(Command& verb, std::string& path) {
  verb.option("--report", path, "FILE.html", "Also write a page with pictures, charts and tables")
      .kind("new file");
}

void check_report(const std::string& path, bool overwrite) {
  if (path.empty()) return;
  const std::string extension = std::filesystem::path(path).extension().string();
  check_writable(path, overwrite);
  if (extension != ".html" && extension != ".htm") refuse("--report", path, "a file name in .html");
}

void Stopwatch::lap(std::string step) {
  const auto now = Clock::now();
  laps_.emplace_back(std::move(step), std::chrono::duration<double>(now - since_).count());
  since_ = now;
}

void write_report(const std::string& path, const ReportPage& page, const Stopwatch& watch,
                  Shell& shell) {
  Texts timings;
  double total = 0;
  for (const auto& [step, s] : watch.laps()) {
    timings.emplace_back(step, seconds(s));
    total += s;
  }
  timings.emplace_back("together", seconds(total));
  const Json data{{"title", page.title},
                  {"lead", page.lead},
                  {"figures", pairs(page.figures)},
                  {"sections", page.sections},
                  {"making", pairs(page.making)},
                  {"timings", pairs(timings)},
                  {"command", shell.command},
                  {"version", DEM_VERSION},
                  {"made", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)))}};

  // No text of the data can end its element: "<" is written as JSON's \u003c.
  std::string text;
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace))
    c == '<' ? text += "\\u003c" : text += c;
  constexpr std::string_view mark = "@data@";
  std::string html(report_page);
  html.replace(html.find(mark), mark.size(), text);
  write_text(path, html, shell.overwrite);
  shell.say("wrote {}", path);
}

Json lines_section(const Panel& panel, std::string note) {
  Json json = section("lines", panel.title, std::move(note));
  json["x"] = axis(panel.x);
  json["y"] = axis(panel.y);
  json["series"] = Json::array();
  for (const auto& s : panel.series) json["series"].push_back(line(s));
  return json;
}

Json spectrum_section(const std::vector<std::pair<std::string, std::vector<SpectrumBin>>>& spectra,
                      std::string note) {
  Panel panel{"Power spectrum",
              {"wavelength, m (long waves at the left)", true, true, {}},
              {"power density, m⁴", true},
              {}};
  for (const auto& [name, bins] : spectra) {
    Series series{name, {}, {}};
    for (const auto& bin : bins)
      if (bin.power_m2 > 0) series.x.push_back(bin.wavelength_m), series.y.push_back(bin.power_m2);
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  return panel.series.empty() ? Json() : lines_section(panel, std::move(note));
}

Json histogram_section(std::string title, std::string note, std::string x_label, double low,
                       double high, const std::vector<std::size_t>& counts,
                       const std::vector<Series>& curves) {
  Json json = section("histogram", std::move(title), std::move(note));
  json["x"] = axis({std::move(x_label)});
  json["y"] = axis({"cells"});
  json["low"] = low;
  json["high"] = high;
  json["counts"] = counts;
  json["series"] = Json::array();
  for (const auto& s : curves) json["series"].push_back(line(s));
  return json;
}

Json bars_section(const Bars& bars) {
  Json json = section("bars", bars.title, bars.note);
  json["x"] = axis({bars.x_label});
  json["y"] = axis({bars.y_label});
  json["classes"] = bars.classes;
  json["series"] = Json::array();
  for (const auto& [name, values] : bars.series)
    json["series"].push_back({{"name", name}, {"values", values}});
  json["counts"] = bars.counts;
  json["counts_label"] = bars.counts_label;
  return json;
}

Json table_section(std::string title, std::string note, std::vector<std::string> columns,
                   Json rows) {
  Json json = section("table", std::move(title), std::move(note));
  json["columns"] = std::move(columns);
  json["rows"] = std::move(rows);
  return json;
}

std::string three_digits(double value) {
  if (value >= 1000) return grouped(std::size_t(std::llround(value)));
  const int digits = value >= 100 ? 0 : value >= 10 ? 1 : value >= 1 ? 2 : 3;
  return decimal(value, digits);
}

std::string decimal(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "";
}

}  // namespace dem::app
