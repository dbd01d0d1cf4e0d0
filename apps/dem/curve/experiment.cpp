#include "curve/experiment.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

#include "dem/io/geodesy.h"
#include "dem/io/methods.h"
#include "dem/sample.h"

namespace dem::app {
namespace {

std::size_t cells_kept(double percent, std::size_t known) {
  return std::clamp<std::size_t>(std::size_t(std::llround(percent / 100 * double(known))), 1,
                                 known - 1);
}

std::vector<std::string> methods_of(const std::vector<Score>& scores) {
  std::vector<std::string> names;
  for (const auto& s : scores)
    if (std::ranges::count(names, s.method) == 0) names.push_back(s.method);
  return names;
}

std::string csv(const std::vector<Score>& scores) {
  std::string text =
      "method,kept_percent,kept_cells,removed_cells,rmse_m,mae_m,bias_m,nmad_m,le90_m,max_m,"
      "slope_rmse_deg,wall_s,cpu_s\n";
  for (const auto& s : scores)
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", s.method, s.percent, s.kept,
                        s.errors.cells, s.errors.rmse_m, s.errors.mae_m, s.errors.bias_m,
                        s.errors.nmad_m, s.errors.le90_m, s.errors.max_m, s.errors.slope_rmse_deg,
                        s.times.wall_s, s.times.cpu_s);
  return text;
}

Score score_of(const Json& j) {
  Score s{j.at("method"), j.at("kept_percent"), j.value("kept_cells", std::size_t{0}), {}, {}};
  s.errors.rmse_m = j.at("rmse_m");
  s.times = {j.at("wall_s"), j.at("cpu_s")};
  return s;
}

Json as_json(const Score& s) {
  return {{"method", s.method},
          {"kept_percent", s.percent},
          {"kept_cells", s.kept},
          {"removed_cells", s.errors.cells},
          {"rmse_m", s.errors.rmse_m},
          {"mae_m", s.errors.mae_m},
          {"bias_m", s.errors.bias_m},
          {"nmad_m", s.errors.nmad_m},
          {"le90_m", s.errors.le90_m},
          {"max_m", s.errors.max_m},
          {"slope_rmse_deg", s.errors.slope_rmse_deg},
          {"wall_s", s.times.wall_s},
          {"cpu_s", s.times.cpu_s}};
}

std::string svg(const std::string& title, const Dem& truth, const CurveOptions& options,
                const std::vector<Score>& scores) {
  std::string note = fmt::format(
      "{} x {} cells, kept at random (seed {}), then filled; time is the median of {} run{}.",
      truth.z.cols(), truth.z.rows(), options.seed, options.repeats,
      options.repeats == 1 ? "" : "s");
  if (!options.rivals.empty())
    note += " Dashed: other programs; their time includes start, reading and writing.";
  return svg_chart(title, note, curve_panels(options, scores));
}

}  // namespace

std::vector<Panel> curve_panels(const CurveOptions& options, const std::vector<Score>& scores) {
  Axis rate{"cells kept, % (logarithmic)", true, true, {}};
  for (double tick : {99.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0})
    if (tick <= std::ranges::max(options.percents) && tick >= std::ranges::min(options.percents))
      rate.ticks.push_back(tick);
  Panel error{"Error", rate, {"RMSE over the removed cells, m", true}, {}};
  Panel time{"Time", rate, {"wall time of one fill, s", true}, {}};
  const auto draw = [&](const std::vector<Score>& from, bool dashed) {
    for (const auto& name : methods_of(from)) {
      Series rmse{name, {}, {}}, wall{name, {}, {}};
      rmse.dashed = wall.dashed = dashed;
      for (const auto& s : from) {
        if (s.method != name || !std::isfinite(s.errors.rmse_m)) continue;
        rmse.x.push_back(s.percent), rmse.y.push_back(std::max(s.errors.rmse_m, 1e-6));
        wall.x.push_back(s.percent), wall.y.push_back(std::max(s.times.wall_s, 1e-6));
      }
      error.series.push_back(rmse);
      time.series.push_back(wall);
    }
  };
  draw(scores, false);
  draw(options.rivals, true);
  return {error, time};
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n == 0 ? 0 : (values[(n - 1) / 2] + values[n / 2]) / 2;
}

std::vector<std::string> CurveOptions::curve_methods() {
  std::vector<std::string> names;
  for (const auto& m : all_fill_methods()) {
    if (m.traits.for_contours) continue;  // cells kept at random are no lines
    names.push_back(m.name);
    for (const auto& p : m.presets)
      if (p.name == "paper") names.push_back(m.name + ":" + p.name);
  }
  return names;
}

std::vector<Score> read_rivals(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw IoError(path, std::strerror(errno));
  try {
    std::vector<Score> scores;
    const Json json = Json::parse(file);
    for (const auto& score : json.at("scores"))
      // Our own methods are measured anew.
      if (!score.at("method").get<std::string>().starts_with("dem "))
        scores.push_back(score_of(score));
    return scores;
  } catch (const Json::exception& error) {
    throw IoError(
        path, fmt::format("no table of scores as scripts/compare.py writes it: {}", error.what()));
  }
}

void check(const CurveOptions& options) {
  std::set<std::string> seen;
  for (const auto& name : options.methods) {
    find_method(all_fill_methods(), name);
    if (!seen.insert(name).second)
      throw std::invalid_argument("methods: " + name + " is there twice");
  }
  for (double p : options.percents)
    if (!(p > 0 && p < 100))
      throw std::invalid_argument(fmt::format("rates: {}; must be above 0 and below 100 %", p));
}

std::vector<Score> measure_curve(const Dem& truth, const CurveOptions& options, const Run& run) {
  check(options);
  const std::size_t known = count(truth.known);
  const auto spacing = spacing_by_row(truth.ref, truth.size());
  const double steps = double(options.methods.size() * options.percents.size());
  std::vector<Score> scores;
  for (double percent : options.percents) {
    const std::size_t kept = cells_kept(percent, known);
    const Dem sampled = sample_random(truth, kept, options.seed);
    const Mask removed = removed_cells(truth, sampled);
    for (const auto& name : options.methods) {
      const double done = double(scores.size());
      run.report(done / steps, fmt::format("{} at {} %", name, percent));
      const ChosenMethod chosen = find_method(all_fill_methods(), name);
      int repeat = 0;
      const auto [filled, times] = timed(options.repeats, [&] {
        const double from = done + repeat / double(options.repeats);
        ++repeat;
        return chosen.method->fill(
            sampled, chosen.settings,
            run.part(from / steps, (done + repeat / double(options.repeats)) / steps));
      });
      scores.push_back(
          {name, percent, kept,
           compare(completed(truth, filled.z), filled.z, removed, spacing, Run{run.threads, {}}),
           times});
    }
  }
  return scores;
}

Json write_curve(const OutputFolder& folder, const std::string& title, const Dem& truth,
                 const CurveOptions& options, const std::vector<Score>& scores, bool overwrite) {
  Json json{{"title", title},         {"cols", truth.z.cols()},
            {"rows", truth.z.rows()}, {"known_cells", count(truth.known)},
            {"seed", options.seed},   {"repeats", options.repeats},
            {"scores", Json::array()}};
  for (const auto& s : scores) json["scores"].push_back(as_json(s));
  for (const auto& s : options.rivals)
    json["rivals"].push_back({{"method", s.method},
                              {"kept_percent", s.percent},
                              {"rmse_m", s.errors.rmse_m},
                              {"wall_s", s.times.wall_s},
                              {"cpu_s", s.times.cpu_s}});
  write_text(folder.file("curves.csv"), csv(scores), overwrite);
  write_text(folder.file("curves.json"), json.dump(1) + "\n", overwrite);
  write_text(folder.file("curves.svg"), svg(title, truth, options, scores), overwrite);
  return json;
}

std::string curve_table(std::vector<Score> scores, const CurveOptions& options) {
  scores.insert(scores.end(), options.rivals.begin(), options.rivals.end());
  const auto methods = methods_of(scores);
  std::map<double, std::map<std::string, const Score*>, std::greater<>> rows;
  for (const auto& s : scores) rows[s.percent][s.method] = &s;

  std::string text;
  const auto table = [&](std::string_view head, auto cell) {
    text += fmt::format("{}\n{:>7}", head, "kept %");
    for (const auto& m : methods) text += fmt::format(" {:>11}", m);
    text += "\n";
    for (const auto& [percent, row] : rows) {
      text += fmt::format("{:>7}", percent);
      for (const auto& m : methods) {
        const auto at = row.find(m);
        const std::string value = at == row.end() ? "-" : cell(*at->second);
        text += fmt::format(" {:>{}}", value, std::max<std::size_t>(11, m.size()));
      }
      text += "\n";
    }
  };
  table("RMSE over the removed cells, m",
        [](const Score& s) { return fmt::format("{:.2f}", s.errors.rmse_m); });
  text += "\n";
  table("wall time, ms",
        [](const Score& s) { return fmt::format("{:.1f}", 1000 * s.times.wall_s); });
  return text;
}

}  // namespace dem::app
