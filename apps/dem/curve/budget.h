#pragma once
// How many cells must be kept for a wanted error, by the way they are chosen.

#include "curve/experiment.h"

namespace dem::app {

struct BudgetOptions {
  std::vector<double> rmse_m;  ///< wanted
  std::string method{default_fill_method()};
  std::vector<double> percents{0.5, 1, 2, 3.4, 5, 10, 20, 30};
  std::uint64_t seed = 1;
};

/// Throws std::invalid_argument.
void check(const BudgetOptions& options);

inline constexpr const char* kBudgetFiles[] = {"budget.csv", "budget.json", "budget.svg"};

/// The error of one way to choose cells, at one number of them; over all known cells.
struct BudgetPoint {
  std::string strategy;
  std::size_t kept = 0;
  double rmse_m = 0, max_error_m = 0;
};

/// Random, regular, silhouette and greedy cells, each reconstructed by the method.
std::vector<BudgetPoint> measure_budget(const Dem& truth, const BudgetOptions& options,
                                        const Run& run);

/// Errors against the cells kept, to be drawn.
std::vector<Panel> budget_panels(const Dem& truth, const std::vector<BudgetPoint>& points);

/// Writes budget.csv, budget.json and budget.svg; returns what budget.json holds.
Json write_budget(const OutputFolder& folder, const std::string& title, const Dem& truth,
                  const BudgetOptions& options, const std::vector<BudgetPoint>& points,
                  bool overwrite);

/// Cells needed for each wanted RMSE, a row for each strategy.
std::string budget_table(const Dem& truth, const BudgetOptions& options,
                         const std::vector<BudgetPoint>& points);

}  // namespace dem::app
