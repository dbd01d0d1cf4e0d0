#include "report/curve_report.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace dem::app {
namespace {

/// A row for each rate, a column for each method.
Json score_table(const std::string& title, const std::vector<Score>& scores,
                 double (*value)(const Score&), int digits) {
  std::vector<std::string> columns{"kept, %"};
  std::map<double, std::map<std::string, double>, std::greater<>> found;
  for (const Score& s : scores) {
    if (std::ranges::find(columns, s.method) == columns.end()) columns.push_back(s.method);
    found[s.percent][s.method] = value(s);
  }
  Json rows = Json::array();
  for (const auto& [percent, by_method] : found) {
    Json row{fmt::format("{:g}", percent)};
    for (std::size_t c = 1; c < columns.size(); ++c) {
      const auto at = by_method.find(columns[c]);
      row.push_back(at == by_method.end() ? "" : decimal(at->second, digits));
    }
    rows.push_back(std::move(row));
  }
  return table_section(title, "", columns, std::move(rows));
}

/// The method that is best at most rates, in a sentence.
std::string winner(const std::vector<Score>& scores) {
  std::map<double, const Score*> best;
  for (const Score& s : scores) {
    const Score*& so_far = best[s.percent];
    if (!so_far || s.errors.rmse_m < so_far->errors.rmse_m) so_far = &s;
  }
  std::map<std::string, std::size_t> wins;
  for (const auto& [percent, score] : best) ++wins[score->method];
  const auto most = std::ranges::max_element(wins, {}, [](const auto& w) { return w.second; });
  return fmt::format("{} is nearest to the truth at {} of {} rates.", most->first, most->second,
                     best.size());
}

}  // namespace

ReportPage curve_page(const std::string& truth, const Dem& dem, const CurveOptions& options,
                      const std::vector<Score>& scores) {
  ReportPage page;
  page.title = "Filling " + name_of(truth);
  page.lead = fmt::format("Cells kept at random, the others filled and compared with the truth. {}",
                          winner(scores));
  page.figures = {{"cells", fmt::format("{} x {}", dem.z.cols(), dem.z.rows())},
                  {"known", grouped(count(dem.known))},
                  {"methods", grouped(options.methods.size())},
                  {"rates", grouped(options.percents.size())}};
  const auto panels = curve_panels(options, scores);
  page.sections.push_back(lines_section(
      panels[0],
      options.rivals.empty() ? "Lower is better." : "Lower is better. Dashed: other programs."));
  page.sections.push_back(lines_section(
      panels[1],
      fmt::format("Median of {} run{}.", options.repeats, options.repeats == 1 ? "" : "s")));
  page.sections.push_back(score_table(
      "RMSE over the removed cells, m", scores, [](const Score& s) { return s.errors.rmse_m; }, 2));
  page.sections.push_back(score_table(
      "Bias, m", scores, [](const Score& s) { return s.errors.bias_m; }, 2));
  page.sections.push_back(score_table(
      "Wall time of one fill, ms", scores, [](const Score& s) { return 1000 * s.times.wall_s; },
      1));
  page.making = {{"TRUTH", truth}, {"seed", fmt::format("{}", options.seed)}};
  return page;
}

ReportPage budget_page(const std::string& truth, const Dem& dem, const BudgetOptions& options,
                       const std::vector<BudgetPoint>& points) {
  ReportPage page;
  page.title = "Cells to keep of " + name_of(truth);
  page.lead = fmt::format("Cells chosen in several ways, the others filled by {}.", options.method);
  page.figures = {{"cells", fmt::format("{} x {}", dem.z.cols(), dem.z.rows())},
                  {"known", grouped(count(dem.known))}};
  for (const Panel& panel : budget_panels(dem, points))
    page.sections.push_back(lines_section(panel, "Lower is better."));
  Json rows = Json::array();
  for (const BudgetPoint& p : points)
    rows.push_back({p.strategy, grouped(p.kept), decimal(p.rmse_m, 2), decimal(p.max_error_m, 1)});
  page.sections.push_back(table_section(
      "Measured", "", {"cells chosen", "kept", "RMSE, m", "largest error, m"}, std::move(rows)));
  page.making = {{"TRUTH", truth}, {"method", options.method}};
  return page;
}

}  // namespace dem::app
