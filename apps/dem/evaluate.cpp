// dem evaluate: how good a reconstruction is.

#include <CLI/CLI.hpp>
#include <algorithm>

#include "scores.h"
#include "verbs.h"

namespace dem::app {
namespace {

struct Options {
  std::string truth, got, known;
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

Scores scores_of(const Options& o, const Run& run) {
  const DemFile truth = read_dem(o.truth, o.read, run.part(0, 0.2));
  const DemFile got = read_dem(o.got, o.read, run.part(0.2, 0.4));
  const Size size = truth.dem.size();
  check_size(o.got, got.dem, size);
  const Mask comparable = known_in_both(truth.dem, got.dem);
  if (count(comparable) == 0) throw IoError(o.got, "no cell is known both here and in TRUTH");
  Mask filled;
  if (!o.known.empty()) {
    const DemFile sampled = read_dem(o.known, o.read, run.part(0.4, 0.6));
    check_size(o.known, sampled.dem, size);
    filled = without_known(comparable, sampled.dem);
    if (count(filled) == 0) throw IoError(o.known, "every cell is known; no filled cell to score");
  }
  return score(truth.dem, got.dem, comparable, filled, run.part(0.6, 1));
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
  const Scores s = scores_of(o, run);
  const Errors& judged = s.filled ? *s.filled : s.all;

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
  verb->add_option("TRUTH", o->truth, "the DEM as it should be")->required()->type_name("");
  verb->add_option("GOT", o->got, "the reconstruction, of the same size")
      ->required()
      ->type_name("");
  verb->add_option("-k,--known", o->known, "what GOT was made from: scores its unknown cells too")
      ->type_name("SAMPLED");
  verb->add_option("-e,--expect", o->expect,
                   "exit 4 unless it holds; of the filled cells if --known")
      ->allow_extra_args(false)
      ->type_name("'rmse<20'");
  add_read_options(*verb, o->read);
}

}  // namespace dem::app
