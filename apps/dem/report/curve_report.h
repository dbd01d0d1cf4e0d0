#pragma once
// What a report shows of curves: errors and times against the share of cells kept.

#include <string>
#include <vector>

#include "curve/budget.h"
#include "curve/experiment.h"
#include "report/page.h"

namespace dem::app {

ReportPage curve_page(const std::string& truth, const Dem& dem, const CurveOptions& options,
                      const std::vector<Score>& scores);

ReportPage budget_page(const std::string& truth, const Dem& dem, const BudgetOptions& options,
                       const std::vector<BudgetPoint>& points);

}  // namespace dem::app
