// dem evaluate: how good a reconstruction is.

#include "dem/evaluate.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "dem/geodesy.h"
#include "report/evaluate_report.h"
#include "verbs.h"

namespace dem::app {
namespace fs = std::filesystem;

namespace {

struct Options {
  std::string truth, got, known, sigma, report;
  std::vector<std::string> expect;
  ReadOptions read;
};

/// A number of Errors, as --expect and the tables name it.
struct Measure {
  const char* name;
  const char* unit;
  double Errors::*value;
  const char* title;  // in a report
};
constexpr Measure kMeasures[] = {{"rmse", "m", &Errors::rmse_m, "RMSE"},
                                 {"mae", "m", &Errors::mae_m, "mean of |error|"},
                                 {"bias", "m", &Errors::bias_m, "bias"},
                                 {"nmad", "m", &Errors::nmad_m, "NMAD"},
                                 {"le90", "m", &Errors::le90_m, "LE90"},
                                 {"max", "m", &Errors::max_m, "largest |error|"},
                                 {"slope_rmse", "deg", &Errors::slope_rmse_deg, "RMSE of slope"}};

/// "rmse<20".
struct Expectation {
  std::string text;
  const Measure* measure;
  bool below, or_equal;
  double bound;

  bool met(const Errors& errors) const {
    const double v = errors.*measure->value;
    return (or_equal && v == bound) || (below ? v < bound : v > bound);
  }
};

Expectation parse_expectation(const std::string& text) {
  const auto at = text.find_first_of("<>");
  const auto measure = std::ranges::find_if(
      kMeasures, [&](const Measure& m) { return text.substr(0, at) == m.name; });
  if (at == std::string::npos || measure == std::end(kMeasures))
    throw std::invalid_argument(
        "expect = " + text +
        "; must be like rmse<20, with one of rmse, mae, bias, nmad, le90, max, "
        "slope_rmse and one of <, <=, >, >=");
  const bool or_equal = text.substr(at + 1).starts_with("=");
  return {
      text, &*measure, text[at] == '<', or_equal,
      parse_number("expect", text.substr(at + 1 + or_equal), "a measure, < or >, and a number")};
}

void check_size(const std::string& path, const Dem& dem, Size size) {
  if (dem.size() != size)
    throw IoError(path, fmt::format("is {} x {} cells; must be {} x {}, as TRUTH", dem.z.cols(),
                                    dem.z.rows(), size.cols, size.rows));
}

Mask both(const Mask& a, const Mask& b) {
  Mask m = a;
  for (std::size_t i = 0; i < m.cells().size(); ++i) m.cells()[i] = a.cells()[i] && b.cells()[i];
  return m;
}

struct Scores {
  Errors all;
  std::optional<Errors> filled;
  std::size_t unfilled = 0;  // cells of the truth that GOT does not know
  std::vector<SpectrumBin> truth, got;
  std::optional<Calibration> calibration;
  Json sections = Json::array();  // of the report
};

/// The standard deviations of a file, 0 where it has none.
Raster<float> read_sigma(const Options& o, Size size, const Run& run) {
  const DemFile file = read_dem(o.sigma, {}, run);
  check_size(o.sigma, file.dem, size);
  return completed(file.dem, Raster<float>(size));
}

Scores score(const Options& o, Stopwatch& watch, const Run& run) {
  const DemFile truth = read_dem(o.truth, o.read, run.part(0, 0.2));
  const DemFile got = read_dem(o.got, o.read, run.part(0.2, 0.4));
  const Size size = truth.dem.size();
  check_size(o.got, got.dem, size);
  watch.lap("reading");
  const Mask comparable = both(truth.dem.known, got.dem.known);
  if (count(comparable) == 0) throw IoError(o.got, "no cell is known both here and in TRUTH");

  Scores scores;
  scores.unfilled = count(truth.dem.known) - count(comparable);
  const auto spacing = spacing_by_row(truth.dem.ref, size);
  const Raster<float> truth_z = completed(truth.dem, got.dem.z),
                      got_z = completed(got.dem, truth.dem.z);
  scores.all = compare(truth_z, got_z, comparable, spacing, run.part(0.4, 0.6));
  Mask where = comparable, known;
  if (!o.known.empty()) {
    const DemFile sampled = read_dem(o.known, o.read, run.part(0.6, 0.7));
    check_size(o.known, sampled.dem, size);
    known = sampled.dem.known;
    for (std::size_t i = 0; i < where.cells().size(); ++i)
      if (known.cells()[i]) where.cells()[i] = 0;
    if (count(where) == 0) throw IoError(o.known, "every cell is known; no filled cell to score");
    scores.filled = compare(truth_z, got_z, where, spacing, run.part(0.7, 0.75));
  }
  Raster<float> sigma;
  if (!o.sigma.empty()) {
    sigma = read_sigma(o, size, run.part(0.75, 0.8));
    scores.calibration = calibration(truth_z, got_z, where, sigma);
    if (scores.calibration->cells == 0)
      throw IoError(o.sigma, "no scored cell has a standard deviation above 0");
  }

  // A spectrum needs whole surfaces, large enough to hold a few waves.
  const bool whole = count(comparable) == size.cells() && size.cols >= 16 && size.rows >= 16;
  if (whole) {
    run.report(0.8, "spectrum");
    scores.truth = power_spectrum(truth.dem.z, truth.dem.spacing);
    scores.got = power_spectrum(got.dem.z, truth.dem.spacing);
  }
  watch.lap("comparing");
  if (!o.report.empty()) {
    scores.sections = error_sections(
        {truth_z, got_z, comparable, where, scores.filled ? *scores.filled : scores.all, known,
         sigma, spacing, truth.dem.spacing},
        scores.truth, scores.got, run.part(0.85, 1));
    watch.lap("drawing");
  }
  return scores;
}

Json as_json(const Errors& e) {
  Json json{{"cells", e.cells}};
  for (const auto& m : kMeasures) json[std::string(m.name) + "_" + m.unit] = e.*m.value;
  return json;
}

std::string error_table(const Scores& s) {
  std::string text =
      fmt::format("{:<12}{:>14}{}\n", "", "all cells", s.filled ? "  filled cells" : "");
  const auto row = [&](std::string_view name, const std::string& all, const std::string& filled,
                       std::string_view unit) {
    text += fmt::format("{:<12}{:>14}{} {}\n", name, all,
                        s.filled ? fmt::format("{:>14}", filled) : "", unit);
  };
  row("cells", grouped(s.all.cells), s.filled ? grouped(s.filled->cells) : "", "");
  for (const auto& m : kMeasures)
    row(m.name, fmt::format("{:.3f}", s.all.*m.value),
        s.filled ? fmt::format("{:.3f}", (*s.filled).*m.value) : "", m.unit);
  if (s.unfilled)
    text += fmt::format("{} cells of TRUTH are unknown in GOT\n", grouped(s.unfilled));
  return text;
}

std::string calibration_text(const Scores& s) {
  if (!s.calibration) return "";
  const Calibration& c = *s.calibration;
  return fmt::format(
      "within 1, 2, 3 sigma: {:.1f}, {:.1f}, {:.1f} % of {} cells (normal distribution: 68.3, "
      "95.4, "
      "99.7 %); rms of error / sigma: {:.3f}\n",
      100 * c.within_1, 100 * c.within_2, 100 * c.within_3, grouped(c.cells), c.rms_ratio);
}

std::string spectrum_table(const Scores& s) {
  if (s.truth.empty()) return "";
  std::string text = "\nspectrum\nwavelength m    truth m^4      got m^4    got/truth\n";
  for (std::size_t i = 0; i < s.truth.size(); ++i)
    text += fmt::format("{:>12.0f}  {:>11.4g}  {:>11.4g}  {:>11.3f}\n", s.truth[i].wavelength_m,
                        s.truth[i].power_m2, s.got[i].power_m2,
                        s.got[i].power_m2 / s.truth[i].power_m2);
  return text;
}

void write_page(const Options& o, Scores s, const Stopwatch& watch, Shell& shell) {
  const Errors& judged = s.filled ? *s.filled : s.all;
  const char* cells = s.filled ? "filled" : "compared";
  ReportPage page;
  page.title = fmt::format("{} against {}", fs::path(o.got).filename().string(),
                           fs::path(o.truth).filename().string());
  page.lead = fmt::format("Over {} {} cells the reconstruction is {:.2f} m off (RMSE).",
                          grouped(judged.cells), cells, judged.rmse_m);
  if (s.unfilled)
    page.lead += fmt::format(" {} cells of TRUTH are unknown in GOT.", grouped(s.unfilled));
  Json rows = Json::array();
  for (const auto& m : kMeasures) {
    if (std::isfinite(judged.*m.value))
      page.figures.emplace_back(m.title, fmt::format("{:.2f} {}", judged.*m.value, m.unit));
    Json row{fmt::format("{}, {}", m.title, m.unit), decimal(s.all.*m.value, 3)};
    if (s.filled) row.push_back(decimal((*s.filled).*m.value, 3));
    rows.push_back(std::move(row));
  }
  page.sections = std::move(s.sections);
  if (s.filled)
    page.sections.push_back(table_section("All cells and filled ones", "",
                                          {"", fmt::format("{} cells", grouped(s.all.cells)),
                                           fmt::format("{} filled", grouped(s.filled->cells))},
                                          std::move(rows)));
  page.making = {{"TRUTH", o.truth}, {"GOT", o.got}};
  if (!o.known.empty()) page.making.emplace_back("made from", o.known);
  if (!o.sigma.empty()) page.making.emplace_back("sigma", o.sigma);
  write_report(o.report, page, watch, shell);
}

int evaluate(const Options& o, Shell& shell) {
  std::vector<Expectation> expectations;
  for (const auto& text : o.expect) expectations.push_back(parse_expectation(text));
  check_report(o.report, shell.overwrite);
  const Run run = shell.run();
  Stopwatch watch;
  const Scores s = score(o, watch, run);
  if (!o.report.empty()) write_page(o, s, watch, shell);
  const Errors& judged = s.filled ? *s.filled : s.all;

  Json json{{"all", as_json(s.all)},        {"filled", s.filled ? as_json(*s.filled) : Json()},
            {"unfilled_cells", s.unfilled}, {"calibration", Json()},
            {"spectrum", Json::array()},    {"expect", Json::array()}};
  for (std::size_t i = 0; i < s.truth.size(); ++i)
    json["spectrum"].push_back({{"wavelength_m", s.truth[i].wavelength_m},
                                {"truth_m4", s.truth[i].power_m2},
                                {"got_m4", s.got[i].power_m2},
                                {"waves", s.truth[i].waves}});
  if (const auto& c = s.calibration)
    json["calibration"] = {{"cells", c->cells},
                           {"within_1_sigma", c->within_1},
                           {"within_2_sigma", c->within_2},
                           {"within_3_sigma", c->within_3},
                           {"rms_ratio", c->rms_ratio}};
  bool all_met = true;
  std::string verdicts;
  for (const auto& e : expectations) {
    const bool met = e.met(judged);
    all_met &= met;
    json["expect"].push_back({{"text", e.text}, {"value", judged.*e.measure->value}, {"met", met}});
    if (!met)
      verdicts += fmt::format("{}expected {}, found {:.6g} {}", verdicts.empty() ? "" : "; ",
                              e.text, judged.*e.measure->value, e.measure->unit);
  }
  shell.print(json, error_table(s) + calibration_text(s) + spectrum_table(s));
  if (!all_met) fmt::print(stderr, "dem: {}: {}\n", o.got, verdicts);
  return all_met ? kDone : kCheckFailed;
}

}  // namespace

void add_evaluate(CLI::App& app, Shell& shell) {
  const auto o = std::make_shared<Options>();
  auto* verb =
      add_verb(app, shell, "evaluate", "How near a reconstruction comes to the truth",
               "  dem evaluate whole.tif filled.tif\n"
               "  dem evaluate whole.tif filled.tif --known sparse.tif   # the filled cells alone\n"
               "  dem evaluate whole.tif filled.tif --expect 'rmse<20' --expect 'bias<=1'\n"
               "  dem evaluate whole.tif filled.tif --known sparse.tif --report errors.html",
               [o, &shell] { return evaluate(*o, shell); });
  verb->add_option("TRUTH", o->truth, "the DEM as it should be")->required()->type_name("");
  verb->add_option("GOT", o->got, "the reconstruction, of the same size")
      ->required()
      ->type_name("");
  verb->add_option("-k,--known", o->known, "what GOT was made from: scores its unknown cells too")
      ->type_name("SAMPLED");
  verb->add_option("--sigma", o->sigma,
                   "what `dem fill --sigma` wrote: how well it foretold the errors")
      ->type_name("FILE");
  add_report_option(*verb, o->report);
  verb->add_option("-e,--expect", o->expect,
                   "exit 4 unless it holds; of the filled cells if --known")
      ->allow_extra_args(false)
      ->type_name("'rmse<20'");
  add_read_options(*verb, o->read);
}

}  // namespace dem::app
