// dem evaluate: how good a reconstruction is.

#include "dem/evaluate.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>

#include "dem/geodesy.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string truth, got, known;
  std::vector<std::string> expect;
  ReadOptions read;
};

/// A number of Errors, as --expect and the tables name it.
struct Measure {
  const char* name;
  const char* unit;
  double Errors::*value;
};
constexpr Measure kMeasures[] = {{"rmse", "m", &Errors::rmse_m},
                                 {"mae", "m", &Errors::mae_m},
                                 {"bias", "m", &Errors::bias_m},
                                 {"nmad", "m", &Errors::nmad_m},
                                 {"le90", "m", &Errors::le90_m},
                                 {"max", "m", &Errors::max_m},
                                 {"slope_rmse", "deg", &Errors::slope_rmse_deg}};

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
};

Scores score(const Options& o, const Run& run) {
  const DemFile truth = read_dem(o.truth, o.read, run.part(0, 0.2));
  const DemFile got = read_dem(o.got, o.read, run.part(0.2, 0.4));
  const Size size = truth.dem.size();
  check_size(o.got, got.dem, size);
  const Mask comparable = both(truth.dem.known, got.dem.known);
  if (count(comparable) == 0) throw IoError(o.got, "no cell is known both here and in TRUTH");

  Scores scores;
  scores.unfilled = count(truth.dem.known) - count(comparable);
  const auto spacing = spacing_by_row(truth.dem.ref, size);
  const Raster<float> truth_z = completed(truth.dem, got.dem.z),
                      got_z = completed(got.dem, truth.dem.z);
  scores.all = compare(truth_z, got_z, comparable, spacing, run.part(0.4, 0.6));
  if (!o.known.empty()) {
    const DemFile sampled = read_dem(o.known, o.read, run.part(0.6, 0.7));
    check_size(o.known, sampled.dem, size);
    Mask where = comparable;
    for (std::size_t i = 0; i < where.cells().size(); ++i)
      if (sampled.dem.known.cells()[i]) where.cells()[i] = 0;
    if (count(where) == 0) throw IoError(o.known, "every cell is known; no filled cell to score");
    scores.filled = compare(truth_z, got_z, where, spacing, run.part(0.7, 0.8));
  }

  // A spectrum needs whole surfaces, large enough to hold a few waves.
  const bool whole = count(comparable) == size.cells() && size.cols >= 16 && size.rows >= 16;
  if (whole) {
    run.report(0.8, "spectrum");
    scores.truth = power_spectrum(truth.dem.z, truth.dem.spacing);
    scores.got = power_spectrum(got.dem.z, truth.dem.spacing);
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

std::string spectrum_table(const Scores& s) {
  if (s.truth.empty()) return "";
  std::string text = "\nspectrum\nwavelength m    truth m^4      got m^4    got/truth\n";
  for (std::size_t i = 0; i < s.truth.size(); ++i)
    text += fmt::format("{:>12.0f}  {:>11.4g}  {:>11.4g}  {:>11.3f}\n", s.truth[i].wavelength_m,
                        s.truth[i].power_m2, s.got[i].power_m2,
                        s.got[i].power_m2 / s.truth[i].power_m2);
  return text;
}

int evaluate(const Options& o, Shell& shell) {
  std::vector<Expectation> expectations;
  for (const auto& text : o.expect) expectations.push_back(parse_expectation(text));
  const Run run = shell.run();
  const Scores s = score(o, run);
  const Errors& judged = s.filled ? *s.filled : s.all;

  Json json{{"all", as_json(s.all)},
            {"filled", s.filled ? as_json(*s.filled) : Json()},
            {"unfilled_cells", s.unfilled},
            {"spectrum", Json::array()},
            {"expect", Json::array()}};
  for (std::size_t i = 0; i < s.truth.size(); ++i)
    json["spectrum"].push_back({{"wavelength_m", s.truth[i].wavelength_m},
                                {"truth_m4", s.truth[i].power_m2},
                                {"got_m4", s.got[i].power_m2},
                                {"waves", s.truth[i].waves}});
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
  shell.print(json, error_table(s) + spectrum_table(s));
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
               "  dem evaluate whole.tif filled.tif --expect 'rmse<20' --expect 'bias<=1'",
               [o, &shell] { return evaluate(*o, shell); });
  verb->add_option("TRUTH", o->truth, "the DEM as it should be")
      ->required()
      ->check(takes("raster"))
      ->type_name("");
  verb->add_option("GOT", o->got, "the reconstruction, of the same size")
      ->required()
      ->check(takes("raster"))
      ->type_name("");
  verb->add_option("-k,--known", o->known, "what GOT was made from: scores its unknown cells too")
      ->check(takes("raster"))
      ->type_name("SAMPLED");
  verb->add_option("-e,--expect", o->expect,
                   "exit 4 unless it holds; of the filled cells if --known")
      ->allow_extra_args(false)
      ->type_name("'rmse<20'");
  add_read_options(*verb, o->read);
}

}  // namespace dem::app
