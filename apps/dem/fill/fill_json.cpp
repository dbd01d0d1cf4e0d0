#include "fill/fill_json.h"

#include <cmath>

namespace dem::app {

Json as_json(const FillPlan& plan, const FillReport& report, const ChosenMethod& chosen,
             const std::string& method) {
  Json aux = Json::array(), figures = Json::array(), settings = Json::object();
  for (const auto& fit : report.guides)
    aux.push_back({{"path", fit.name},
                   {"offset_m", fit.offset_m},
                   {"shift_cells", {fit.shift_cols, fit.shift_rows}},
                   {"warning", fit.warning}});
  for (const auto& f : report.figures)
    figures.push_back({{"name", f.name}, {"value", f.value}, {"unit", f.unit}});
  for (const auto& [key, value] : chosen.settings) settings[key] = value;
  return {{"method", method},
          {"settings", settings},
          {"unknown", report.unknown},
          {"voids", plan.holes.size()},
          {"border_voids", report.border_holes},
          {"border_void_cells", report.border_cells},
          {"windows", report.windows},
          {"filled", report.filled},
          {"water", report.water_cells},
          {"over_aux", report.guide_cells},
          {"aux", aux},
          {"left_at_border", report.left_at_border},
          {"left_by_choice", report.left_by_choice},
          {"left", report.left},
          {"known_unchanged", report.known_kept},
          {"known_checksum", fmt::format("{:016x}", report.known_checksum)},
          {"seconds", report.seconds},
          {"report", figures}};
}

Json hole_table(const FillPlan& plan, const FillReport& report, const std::string& method) {
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(); };
  Json table = Json::array();
  for (std::size_t h = 0; h < plan.holes.size(); ++h) {
    const Hole& hole = plan.holes[h];
    const HoleOutcome& o = report.outcomes[h];
    Json row = {{"first_col", hole.first_col}, {"first_row", hole.box.row}};
    for (const HoleFact& fact : hole_facts()) row[fact.name] = number(fact.value(hole));
    if (plan.verdicts[h] != Verdict::fill)
      row["left_by"] = name_of(plan.verdicts[h]);
    else
      row.update({{"method", method},
                  {"aux", o.guide >= 0 ? Json(report.guides[std::size_t(o.guide)].name) : Json()},
                  {"aux_offset_m", number(o.offset_m)},
                  {"filled", o.method_cells + o.guide_cells + o.water_cells},
                  {"water", o.water_cells},
                  {"left", o.left_cells},
                  {"rim_error_m", number(o.rim_error_m)},
                  {"window_cells", o.window_cells},
                  {"window_seconds", o.seconds}});
    table.push_back(std::move(row));
  }
  return table;
}

std::string left_text(const FillPlan& plan) {
  std::string text;
  for (std::size_t v = 1; v < verdicts; ++v) {
    std::size_t n = 0, cells = 0;
    for (std::size_t h = 0; h < plan.holes.size(); ++h)
      if (plan.verdicts[h] == Verdict(v)) ++n, cells += plan.holes[h].cells;
    if (n > 0)
      text += fmt::format(", {} left in {} void{} by {}", grouped(cells), grouped(n),
                          n == 1 ? "" : "s", option_of(name_of(Verdict(v))));
  }
  return text;
}

}  // namespace dem::app
