#include "fill/hole_fill.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "dem/io/geodesy.h"
#include "dem/io/polygons.h"

namespace dem::app {
namespace {

/// Above this share of unknown cells the raster is one problem: its known cells are samples, not
/// surroundings of holes.
constexpr double whole_share = 0.25;

LatticeOrigin lattice_origin(const GeoRef& ref) {
  const auto& at = ref.to_world;
  const auto index = [](double position, double step) {
    const double cells = step != 0 ? position / step : 0;
    return std::abs(cells) < 1e15 ? std::int64_t(std::floor(cells + 0.5)) : 0;
  };
  return {index(at[0], at[1]), index(at[3], at[5])};
}

}  // namespace

FillPlan plan_fill(const FillRequest& request, const std::vector<Hole>& holes, Size raster,
                   const GeoRef& ref, FillOutcome& outcome) {
  FillPlan plan;
  plan.verdicts = judge(request.choice, holes);
  std::vector<std::uint8_t> chosen;
  std::size_t cells = 0;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    const Hole& hole = holes[h];
    const Verdict verdict = plan.verdicts[h];
    outcome.unknown += hole.cells;
    outcome.border_holes += hole.at_border;
    if (hole.at_border) outcome.border_cells += hole.cells;
    if (verdict == Verdict::at_border) outcome.left_at_border += hole.cells;
    if (verdict != Verdict::at_border && verdict != Verdict::fill)
      outcome.left_by_choice += hole.cells;
    chosen.push_back(verdict == Verdict::fill);
    if (chosen.back()) cells += hole.cells;
    outcome.outcomes.push_back({verdict, 0, 0, 0, 0, -1, NAN, NAN, 0, 0});
  }
  plan.whole = request.whole || double(cells) > whole_share * double(raster.cells());
  if (plan.whole && cells > 0) {
    plan.windows = {{{0, 0, raster.cols, raster.rows}, {}}};
    for (std::uint32_t h = 0; h < holes.size(); ++h)
      if (chosen[h]) plan.windows[0].holes.push_back(h);
  } else {
    plan.windows = plan_windows(holes, chosen, raster, lattice_origin(ref));
  }
  outcome.windows = plan.windows.size();
  return plan;
}

std::function<Filled(const Dem&, const Run&)> filler(const ChosenMethod& chosen) {
  return [chosen](const Dem& dem, const Run& run) {
    return chosen.method->fill(dem, chosen.settings, run);
  };
}

void account(const HolePatch& patch, const FillPlan& plan, FillOutcome& outcome) {
  for (std::size_t i = 0; i < patch.holes.size(); ++i) {
    HoleOutcome& hole = outcome.outcomes[patch.holes[i]];
    hole.guide = patch.guide[i];
    hole.rim_error_m = patch.rim_error_m[i];
    hole.offset_m = patch.offset_m[i];
    hole.seconds = patch.seconds;
    hole.window_cells = plan.windows[patch.window].box.cells();
    const auto& cells = patch.cells_by_origin[i];
    hole.method_cells = cells[0];
    hole.guide_cells = cells[1];
    hole.water_cells = cells[2];
    hole.left_cells = cells[3];
    outcome.left += hole.left_cells;
    outcome.filled += hole.method_cells + hole.guide_cells + hole.water_cells;
    outcome.water_cells += hole.water_cells;
    outcome.guide_cells += hole.guide_cells;
  }
  if (plan.windows.size() == 1) outcome.figures = patch.report;
  outcome.contour_lines = outcome.contour_lines || patch.contour_lines;
}

FillOutcome fill_holes_of(Dem& dem, const FillRequest& request, const Run& run) {
  FillOutcome out;
  const Size size = dem.size();
  const auto spacing = spacing_by_row(dem.ref, size);
  Mask region;
  if (!request.choice.region.empty())
    region = Polygons(request.choice.region, dem.ref).cells_in({0, 0, size.cols, size.rows});
  out.holes = find_holes(dem, spacing, region);
  out.known_checksum = known_checksum(dem);
  const FillPlan plan = plan_fill(request, out.holes, size, dem.ref, out);
  if (request.keep_sigma) out.sigma = Raster<float>(size);
  if (request.keep_origin) {
    out.origin = Raster<std::uint8_t>(size);
    for (std::size_t i = 0; i < size.cells(); ++i)
      out.origin.cells()[i] =
          std::uint8_t(dem.known.cells()[i] ? CellOrigin::measured : CellOrigin::left);
  }

  FillLayers layers(request.aux, request.water, dem.ref);
  HoleWork work;
  work.flat_water = !plan.whole;
  work.rim_errors = request.rim_errors;
  work.fill = filler(request.method);
  work.read = [&](const Box& box) {
    WindowData data{crop(dem, box, spacing[std::size_t(box.row + box.rows / 2)]), {}, {}};
    layers.add(data, box);
    return data;
  };
  // Heights go straight to their place; while others still look at the mask, it stays as it is.
  std::vector<CellRun> filled;
  work.take = [&](HolePatch&& patch) {
    account(patch, plan, out);
    std::size_t cell = 0;
    for (const CellRun& cells : patch.runs)
      for (int col = cells.begin; col < cells.end; ++col, ++cell) {
        if (request.keep_origin) out.origin(col, cells.row) = std::uint8_t(patch.origin[cell]);
        if (patch.origin[cell] == CellOrigin::left) continue;
        dem.z(col, cells.row) = patch.z[cell];
        if (!patch.sigma.empty() && request.keep_sigma)
          out.sigma(col, cells.row) = patch.sigma[cell];
        if (!filled.empty() && filled.back().row == cells.row && filled.back().end == col)
          ++filled.back().end;
        else
          filled.push_back({cells.row, col, col + 1});
      }
  };
  const auto start = std::chrono::steady_clock::now();
  fill_windows(out.holes, plan.windows, work, run);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.aux = layers.fits();
  out.known_kept = known_checksum(dem) == out.known_checksum;
  for (const CellRun& cells : filled)
    std::fill_n(dem.known.row(cells.row).begin() + cells.begin, cells.end - cells.begin,
                std::uint8_t{1});
  return out;
}

Json as_json(const FillOutcome& out, const std::string& method, const Settings& chosen) {
  Json aux = Json::array(), figures = Json::array(), settings = Json::object();
  for (const auto& fit : out.aux)
    aux.push_back({{"path", fit.path},
                   {"offset_m", fit.offset_m},
                   {"shift_cells", {fit.shift_cols, fit.shift_rows}},
                   {"warning", fit.warning}});
  for (const auto& f : out.figures)
    figures.push_back({{"name", f.name}, {"value", f.value}, {"unit", f.unit}});
  for (const auto& [key, value] : chosen) settings[key] = value;
  return {{"method", method},
          {"settings", settings},
          {"unknown", out.unknown},
          {"voids", out.holes.size()},
          {"border_voids", out.border_holes},
          {"border_void_cells", out.border_cells},
          {"windows", out.windows},
          {"filled", out.filled},
          {"water", out.water_cells},
          {"over_aux", out.guide_cells},
          {"aux", aux},
          {"left_at_border", out.left_at_border},
          {"left_by_choice", out.left_by_choice},
          {"left", out.left},
          {"known_unchanged", out.known_kept},
          {"known_checksum", fmt::format("{:016x}", out.known_checksum)},
          {"seconds", out.seconds},
          {"report", figures}};
}

Json hole_table(const FillOutcome& outcome, const std::string& method) {
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(); };
  Json table = Json::array();
  for (std::size_t h = 0; h < outcome.holes.size(); ++h) {
    const Hole& hole = outcome.holes[h];
    const HoleOutcome& o = outcome.outcomes[h];
    Json row = {{"first_col", hole.first_col}, {"first_row", hole.box.row}};
    for (const HoleFact& fact : hole_facts()) row[fact.name] = number(fact.value(hole));
    if (o.verdict != Verdict::fill)
      row["left_by"] = text_of(o.verdict);
    else
      row.update({{"method", method},
                  {"aux", o.guide >= 0 ? Json(outcome.aux[std::size_t(o.guide)].path) : Json()},
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

}  // namespace dem::app
