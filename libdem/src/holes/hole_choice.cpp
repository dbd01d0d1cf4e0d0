#include "dem/hole_choice.h"

#include <fmt/format.h>

#include <array>
#include <functional>
#include <stdexcept>

namespace dem {

std::vector<Field> fields(HoleChoice& choice) {
  const Range above_zero{.min = 0, .above_min = true};
  return {
      {"inner_only", choice.inner_only, "leave voids that touch the border of the raster"},
      {"max_area_km2", choice.max_area_km2, above_zero, "km2", "fill only voids up to this area"},
      {"max_distance_m", choice.max_distance_m, above_zero, "m",
       "fill only voids without a cell farther than this from the nearest known cell"},
      {"min_cells",
       choice.min_cells,
       {.min = 1},
       "cells",
       "fill only voids of at least this number of cells"},
      {"where", choice.where, "fill only voids that meet a condition, such as area_km2 < 5"}};
}

void check(const HoleChoice& choice) {
  check_options(choice);
  if (!choice.where.empty()) parse_hole_filter(choice.where);
}

std::string text_of(const HoleChoice& choice) {
  return fmt::format("{} {} {} {} {}", choice.inner_only, choice.max_area_km2.value_or(-1),
                     choice.max_distance_m.value_or(-1), choice.min_cells.value_or(0),
                     choice.where);
}

std::string_view name_of(Verdict verdict) {
  constexpr std::array<std::string_view, verdicts> names{
      "fill",           "inner_only", "max_area_km2", "min_cells",
      "max_distance_m", "where",      "region",       "memory"};
  return names[std::size_t(verdict)];
}

std::vector<Verdict> judge(const HoleChoice& choice, const std::vector<Hole>& holes,
                           bool in_region) {
  std::function<bool(const Hole&)> where;
  if (!choice.where.empty()) where = parse_hole_filter(choice.where);
  std::vector<Verdict> out;
  for (const Hole& hole : holes)
    out.push_back(choice.inner_only && hole.at_border ? Verdict::inner_only
                  : choice.max_area_km2 && hole.area_m2 > 1e6 * *choice.max_area_km2
                      ? Verdict::max_area_km2
                  : choice.min_cells && hole.cells < *choice.min_cells ? Verdict::min_cells
                  : choice.max_distance_m && hole.distance_m > *choice.max_distance_m
                      ? Verdict::max_distance_m
                  : where && !where(hole)               ? Verdict::where
                  : in_region && hole.marked_cells == 0 ? Verdict::region
                                                        : Verdict::fill);
  return out;
}

}  // namespace dem
