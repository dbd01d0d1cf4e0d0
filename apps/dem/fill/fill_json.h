#pragma once
// What was filled, as JSON: for --json, --report-holes and Python.

#include <string>
#include <vector>

#include "common.h"
#include "dem/fill.h"

namespace dem::app {

/// What was done, as `dem fill --json` prints it, and `libdem.fill` reports it.
Json as_json(const FillPlan& plan, const FillReport& report, const ChosenMethod& chosen,
             const std::string& method);

/// The table of voids.
Json hole_table(const FillPlan& plan, const FillReport& report, const std::string& method);

/// ", 12 034 cells left in 3 voids by inner_only, ..." or "".
std::string left_text(const FillPlan& plan);

}  // namespace dem::app
