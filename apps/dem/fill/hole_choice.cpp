#include "fill/hole_choice.h"

#include <array>

namespace dem::app {
namespace {

constexpr std::size_t verdicts = 8;

}  // namespace

void HoleChoice::add_options(Command& command) {
  command.heading("Which holes (all by default)");
  command.flag("--inner-only", inner_only, "Leave holes that touch the border of the raster");
  command
      .option("--max-area-km2", max_area_km2, "A", "Fill only holes up to this area on the ground")
      .above(0);
  command
      .option("--max-distance-m", max_distance_m, "D",
              "Fill only holes where no cell is further than this from the nearest known cell")
      .above(0);
  command.option("--min-cells", min_cells, "N",
                 "Fill only holes with at least this number of cells");
  command.option("--where", where, "CONDITION",
                 "Fill only holes that meet a condition (see below)");
  command
      .option("--region", region, "FILE",
              "Fill only holes with a cell in these polygons, in any format that OGR opens")
      .kind("vector");
  command.heading("Options");
}

std::string HoleChoice::condition_help() {
  std::string text = "Conditions: \"area_km2 < 5 and not at_border\", of";
  std::size_t width = text.size();
  for (const HoleFact& fact : hole_facts()) {
    if (width + fact.name.size() > 96) text += "\n ", width = 2;
    text += " " + fact.name;
    width += fact.name.size() + 1;
  }
  return text + "\n";
}

std::string HoleChoice::text() const {
  return fmt::format("{} {} {} {} {} {}", inner_only, max_area_km2.value_or(-1),
                     max_distance_m.value_or(-1), min_cells.value_or(0), where, region);
}

std::string_view text_of(Verdict verdict) {
  constexpr std::array<std::string_view, verdicts> texts{
      "fill",    "--inner-only", "--max-area-km2", "--min-cells", "--max-distance-m",
      "--where", "--region",     "--memory"};
  return texts[std::size_t(verdict)];
}

void check(const HoleChoice& choice) {
  if (!choice.where.empty()) parse_hole_filter(choice.where);
}

std::vector<Verdict> judge(const HoleChoice& choice, const std::vector<Hole>& holes) {
  std::function<bool(const Hole&)> where;
  if (!choice.where.empty()) where = parse_hole_filter(choice.where);
  std::vector<Verdict> out;
  for (const Hole& hole : holes)
    out.push_back(
        choice.inner_only && hole.at_border                                 ? Verdict::at_border
        : choice.max_area_km2 && hole.area_m2 > 1e6 * *choice.max_area_km2  ? Verdict::too_large
        : choice.min_cells && hole.cells < *choice.min_cells                ? Verdict::too_small
        : choice.max_distance_m && hole.distance_m > *choice.max_distance_m ? Verdict::too_deep
        : where && !where(hole)                                             ? Verdict::where
        : !choice.region.empty() && hole.marked_cells == 0                  ? Verdict::region
                                                                            : Verdict::fill);
  return out;
}

std::string left_text(const std::vector<Hole>& holes, const std::vector<Verdict>& verdict) {
  std::string text;
  for (std::size_t v = 1; v < verdicts; ++v) {
    std::size_t n = 0, cells = 0;
    for (std::size_t h = 0; h < holes.size(); ++h)
      if (verdict[h] == Verdict(v)) ++n, cells += holes[h].cells;
    if (n > 0)
      text += fmt::format(", {} left in {} voids by {}", grouped(cells), grouped(n),
                          text_of(Verdict(v)));
  }
  return text;
}

}  // namespace dem::app
