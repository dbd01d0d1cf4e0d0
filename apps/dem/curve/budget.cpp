#include "curve/budget.h"

#include <algorithm>
#include <cmath>

#include "dem/greedy.h"
#include "dem/io/methods.h"
#include "dem/sample.h"

namespace dem::app {
namespace {

const std::vector<std::string> kStrategies{"random", "regular", "silhouette", "greedy"};

BudgetPoint reconstruct(const std::string& strategy, const Dem& truth, const Dem& sampled,
                        const ChosenMethod& method, const Run& run) {
  const Raster<float> got = method.method->fill(sampled, method.settings, run).z;
  BudgetPoint point{strategy, count(sampled.known), 0, 0};
  double squares = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < got.cells().size(); ++i) {
    if (!truth.known.cells()[i]) continue;
    const double error = std::abs(double(got.cells()[i]) - double(truth.z.cells()[i]));
    squares += error * error;
    point.max_error_m = std::max(point.max_error_m, error);
    ++n;
  }
  point.rmse_m = std::sqrt(squares / double(n));
  return point;
}

Dem sampled_by(const std::string& strategy, const Dem& truth, double percent, std::uint64_t seed) {
  const std::size_t known = count(truth.known);
  const auto cells =
      std::clamp<std::size_t>(std::size_t(std::llround(percent / 100 * double(known))), 4, known);
  if (strategy == "random") return sample_random(truth, cells, seed);
  if (strategy == "regular")
    return sample_regular(truth, std::max(1, int(std::lround(std::sqrt(100 / percent)))));
  return sample_edges(truth, cells);
}

std::vector<const BudgetPoint*> of(const std::string& strategy,
                                   const std::vector<BudgetPoint>& points) {
  std::vector<const BudgetPoint*> some;
  for (const BudgetPoint& p : points)
    if (p.strategy == strategy) some.push_back(&p);
  std::ranges::sort(some, {}, &BudgetPoint::kept);
  return some;
}

/// Cells for a wanted error, between the measured numbers by logarithms; 0: more than were
/// measured.
double cells_needed(const std::vector<const BudgetPoint*>& curve, double rmse_m) {
  for (std::size_t i = 0; i < curve.size(); ++i) {
    if (curve[i]->rmse_m > rmse_m) continue;
    if (i == 0) return double(curve[0]->kept);
    const BudgetPoint &a = *curve[i - 1], &b = *curve[i];
    const double from = std::log(a.rmse_m), to = std::log(std::max(b.rmse_m, 1e-9));
    const double t = (from - std::log(rmse_m)) / (from - to);
    return double(a.kept) * std::pow(double(b.kept) / double(a.kept), t);
  }
  return 0;
}

std::string svg(const std::string& title, const Dem& truth, const BudgetOptions& options,
                const std::vector<BudgetPoint>& points) {
  std::vector<Panel> panels = budget_panels(truth, points);
  panels.front().levels = options.rmse_m;
  return svg_chart(
      title,
      fmt::format("{} x {} cells, reconstructed by {} from the cells kept. Dotted: the "
                  "RMSE asked for, {} m.",
                  truth.z.cols(), truth.z.rows(), options.method, fmt::join(options.rmse_m, ", ")),
      panels);
}

}  // namespace

std::vector<Panel> budget_panels(const Dem& truth, const std::vector<BudgetPoint>& points) {
  const double all = double(count(truth.known));
  Panel error{"Error",
              {"cells kept, % (logarithmic)", true, false, {}},
              {"RMSE over all cells, m", true},
              {}};
  Panel worst{"Worst cell", error.x, {"largest error, m", true}, {}};
  for (const auto& strategy : kStrategies) {
    Series rmse{strategy, {}, {}}, most{strategy, {}, {}};
    for (const BudgetPoint* p : of(strategy, points)) {
      const double percent = 100 * double(p->kept) / all;
      rmse.x.push_back(percent), rmse.y.push_back(std::max(p->rmse_m, 1e-6));
      most.x.push_back(percent), most.y.push_back(std::max(p->max_error_m, 1e-6));
    }
    error.series.push_back(rmse);
    worst.series.push_back(most);
  }
  return {error, worst};
}

void check(const BudgetOptions& options) {
  find_method(all_fill_methods(), options.method);
  for (const double r : options.rmse_m)
    if (!(r > 0)) throw std::invalid_argument(fmt::format("budget = {}; must be above 0 m", r));
  for (const double p : options.percents)
    if (!(p > 0 && p < 100))
      throw std::invalid_argument(fmt::format("rates: {}; must be above 0 and below 100 %", p));
}

std::vector<BudgetPoint> measure_budget(const Dem& truth, const BudgetOptions& options,
                                        const Run& run) {
  const ChosenMethod method = find_method(all_fill_methods(), options.method);
  const Run quiet{run.threads, [&run](double, std::string_view) {
                    return !run.progress || run.progress(0, "measuring");
                  }};
  std::vector<BudgetPoint> points;
  for (const std::string strategy : {"random", "regular", "silhouette"})
    for (const double percent : options.percents) {
      const Dem sampled = sampled_by(strategy, truth, percent, options.seed);
      points.push_back(reconstruct(strategy, truth, sampled, method, quiet));
    }
  const std::size_t known = count(truth.known);
  const double most = std::ranges::max(options.percents) / 100 * double(known);
  const GreedySample greedy = sample_greedy(
      truth, method, {.count = std::clamp<std::size_t>(std::size_t(most), 4, known)}, quiet);
  const double least = std::ranges::min(options.percents) / 100 * double(known);
  for (std::size_t i = 0; i < greedy.rounds.size(); ++i) {
    const GreedyRound& r = greedy.rounds[i];
    // The last rounds add few cells: one of them stands for all.
    const bool as_many =
        i + 1 < greedy.rounds.size() && double(greedy.rounds[i + 1].kept) < 1.02 * double(r.kept);
    if (double(r.kept) >= least && !as_many)
      points.push_back({"greedy", r.kept, r.rmse_m, r.max_error_m});
  }
  return points;
}

Json write_budget(const OutputFolder& folder, const std::string& title, const Dem& truth,
                  const BudgetOptions& options, const std::vector<BudgetPoint>& points,
                  bool overwrite) {
  Json json{{"title", title},           {"cols", truth.z.cols()},
            {"rows", truth.z.rows()},   {"known_cells", count(truth.known)},
            {"method", options.method}, {"seed", options.seed},
            {"points", Json::array()},  {"needed", Json::array()}};
  std::string csv = "strategy,kept_cells,rmse_m,max_error_m\n";
  for (const BudgetPoint& p : points) {
    json["points"].push_back({{"strategy", p.strategy},
                              {"kept_cells", p.kept},
                              {"rmse_m", p.rmse_m},
                              {"max_error_m", p.max_error_m}});
    csv += fmt::format("{},{},{},{}\n", p.strategy, p.kept, p.rmse_m, p.max_error_m);
  }
  for (const double wanted : options.rmse_m)
    for (const auto& strategy : kStrategies)
      json["needed"].push_back({{"rmse_m", wanted},
                                {"strategy", strategy},
                                {"cells", std::round(cells_needed(of(strategy, points), wanted))}});
  write_text(folder.file("budget.csv"), csv, overwrite);
  write_text(folder.file("budget.json"), json.dump(1) + "\n", overwrite);
  write_text(folder.file("budget.svg"), svg(title, truth, options, points), overwrite);
  return json;
}

std::string budget_table(const Dem& truth, const BudgetOptions& options,
                         const std::vector<BudgetPoint>& points) {
  std::string text =
      fmt::format("cells needed, % of {}\n{:>12}", grouped(count(truth.known)), "RMSE, m");
  for (const auto& strategy : kStrategies) text += fmt::format(" {:>11}", strategy);
  text += "\n";
  for (const double wanted : options.rmse_m) {
    text += fmt::format("{:>12}", wanted);
    for (const auto& strategy : kStrategies) {
      const double cells = cells_needed(of(strategy, points), wanted);
      const double percent = 100 * cells / double(count(truth.known));
      text += fmt::format(" {:>11}", cells > 0 ? fmt::format("{:.2f}", percent) : "more");
    }
    text += "\n";
  }
  return text;
}

}  // namespace dem::app
