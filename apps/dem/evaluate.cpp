// dem evaluate: how good a reconstruction is.

#include <algorithm>
#include <cmath>

#include "evaluation_json.h"
#include "report/evaluate_report.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string truth, got, known, sigma, report;
  std::vector<std::string> expect;
  ReadOptions read;
};

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
      measures, [&](const Measure& m) { return text.substr(0, at) == m.name; });
  if (at == std::string::npos || measure == std::end(measures))
    refuse("--expect", text,
           "like rmse<20, with one of rmse, mae, bias, nmad, le90, max, slope_rmse and one of <, "
           "<=, >, >=");
  const bool or_equal = text.substr(at + 1).starts_with("=");
  return {
      text, &*measure, text[at] == '<', or_equal,
      parse_number("--expect", text.substr(at + 1 + or_equal), "a measure, < or >, and a number")};
}

/// A message of evaluate_dem, with the file that it speaks of.
IoError with_file(const Options& o, std::string_view message) {
  const std::string& file = message.starts_with("sampled") ? o.known
                            : message.starts_with("sigma") ? o.sigma
                                                           : o.got;
  return {file, std::string(message)};
}

/// Evaluates; and makes the sections of a report, when one is asked for.
Evaluation evaluate_files(const Options& o, Json& sections, Stopwatch& watch, const Run& run) {
  const DemFile truth = read_dem(o.truth, o.read, run.part(0, 0.2));
  const DemFile got = read_dem(o.got, o.read, run.part(0.2, 0.4));
  DemFile sampled;
  if (!o.known.empty()) sampled = read_dem(o.known, o.read, run.part(0.4, 0.5));
  Raster<float> sigma;
  if (!o.sigma.empty()) {
    const DemFile file = read_dem(o.sigma, {}, run.part(0.5, 0.6));
    sigma = completed(file.dem, Raster<float>(file.dem.size()));
  }
  watch.lap("reading");
  Evaluation evaluation;
  try {
    evaluation =
        evaluate_dem(truth.dem, got.dem,
                     {o.known.empty() ? nullptr : &sampled.dem, o.sigma.empty() ? nullptr : &sigma},
                     run.part(0.6, 0.85));
  } catch (const std::invalid_argument& error) {
    throw with_file(o, error.what());
  }
  watch.lap("comparing");
  if (!o.report.empty()) {
    const Raster<float> truth_z = completed(truth.dem, got.dem.z),
                        got_z = completed(got.dem, truth.dem.z);
    const std::vector<Spacing> spacing = spacing_of_rows(truth.dem);
    sections = error_sections(
        {truth_z, got_z, evaluation.comparable, evaluation.judged, evaluation.judged_errors(),
         std::move(sampled.dem.known), std::move(sigma), spacing, truth.dem.spacing},
        evaluation.truth, evaluation.got, run.part(0.85, 1));
    watch.lap("drawing");
  }
  return evaluation;
}

std::string error_table(const Evaluation& s) {
  std::string text =
      fmt::format("{:<12}{:>14}{}\n", "", "all cells", s.filled ? "  filled cells" : "");
  const auto row = [&](std::string_view name, const std::string& all, const std::string& filled,
                       std::string_view unit) {
    text += fmt::format("{:<12}{:>14}{} {}\n", name, all,
                        s.filled ? fmt::format("{:>14}", filled) : "", unit);
  };
  row("cells", grouped(s.all.cells), s.filled ? grouped(s.filled->cells) : "", "");
  for (const auto& m : measures)
    row(m.name, fmt::format("{:.3f}", s.all.*m.value),
        s.filled ? fmt::format("{:.3f}", (*s.filled).*m.value) : "", m.unit);
  if (s.unfilled)
    text += fmt::format("{} cells of TRUTH are unknown in GOT\n", grouped(s.unfilled));
  return text;
}

std::string calibration_text(const Evaluation& s) {
  if (!s.calibration) return "";
  const Calibration& c = *s.calibration;
  return fmt::format(
      "within 1, 2, 3 sigma: {:.1f}, {:.1f}, {:.1f} % of {} cells (normal distribution: 68.3, "
      "95.4, "
      "99.7 %); rms of error / sigma: {:.3f}\n",
      100 * c.within_1, 100 * c.within_2, 100 * c.within_3, grouped(c.cells), c.rms_ratio);
}

std::string spectrum_table(const Evaluation& s) {
  if (s.truth.empty()) return "";
  std::string text = "\nspectrum\nwavelength m    truth m^4      got m^4    got/truth\n";
  for (std::size_t i = 0; i < s.truth.size(); ++i)
    text += fmt::format("{:>12.0f}  {:>11.4g}  {:>11.4g}  {:>11.3f}\n", s.truth[i].wavelength_m,
                        s.truth[i].power_m2, s.got[i].power_m2,
                        s.got[i].power_m2 / s.truth[i].power_m2);
  return text;
}

void write_page(const Options& o, const Evaluation& s, Json sections, const Stopwatch& watch,
                Shell& shell) {
  const Errors& judged = s.judged_errors();
  const char* cells = s.filled ? "filled" : "compared";
  ReportPage page;
  page.title = fmt::format("{} against {}", name_of(o.got), name_of(o.truth));
  page.lead = fmt::format("Over {} {} cells the reconstruction is {:.2f} m off (RMSE).",
                          grouped(judged.cells), cells, judged.rmse_m);
  if (s.unfilled)
    page.lead += fmt::format(" {} cells of TRUTH are unknown in GOT.", grouped(s.unfilled));
  Json rows = Json::array();
  for (const auto& m : measures) {
    if (std::isfinite(judged.*m.value))
      page.figures.emplace_back(m.title, fmt::format("{:.2f} {}", judged.*m.value, m.unit));
    Json row{fmt::format("{}, {}", m.title, m.unit), decimal(s.all.*m.value, 3)};
    if (s.filled) row.push_back(decimal((*s.filled).*m.value, 3));
    rows.push_back(std::move(row));
  }
  page.sections = std::move(sections);
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
  Json sections;
  const Evaluation s = evaluate_files(o, sections, watch, run);
  if (!o.report.empty()) write_page(o, s, std::move(sections), watch, shell);
  const Errors& judged = s.judged_errors();

  Json json = as_json(s);
  json["expect"] = Json::array();
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

void add_evaluate(Program& program, Shell& shell) {
  const auto o = std::make_shared<Options>();
  Command& verb =
      program.add("evaluate", kMeasure, "Compare a DEM with a reference",
                  "  dem evaluate whole.tif filled.tif\n"
                  "  dem evaluate whole.tif filled.tif --known sparse.tif   # filled cells apart\n"
                  "  dem evaluate whole.tif filled.tif --expect 'rmse<20' --expect 'bias<=1'\n"
                  "  dem evaluate whole.tif filled.tif --known sparse.tif --report errors.html");
  verb.work = [o, &shell] { return evaluate(*o, shell); };
  verb.argument("TRUTH", o->truth, "Reference DEM").kind("raster").must_be_given();
  verb.argument("GOT", o->got, "DEM to evaluate, with as many columns and rows as TRUTH")
      .kind("raster")
      .must_be_given();
  verb.option("-k,--known", o->known, "SAMPLED",
              "DEM that GOT was made from; its nodata cells are also evaluated apart")
      .kind("raster");
  verb.option(
          "--sigma", o->sigma, "FILE",
          "Standard errors written by `dem fill --sigma`, to be checked against the real errors")
      .kind("raster");
  add_report_option(verb, o->report);
  verb.option("-e,--expect", o->expect, "'rmse<20'",
              "Condition on the errors (of the filled cells if --known is given); exit code 4 when "
              "it does not hold");
  add_read_options(verb, o->read);
}

}  // namespace dem::app
