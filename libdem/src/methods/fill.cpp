#include "dem/fill.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "methods/guide_fit.h"

namespace dem {
namespace {

/// Above this share of unknown cells the raster is one window: its known cells are samples, not
/// surroundings of voids.
constexpr double whole_share = 0.25;

/// Adds what a patch says to the report.
void account(const HolePatch& patch, const FillPlan& plan, FillReport& report) {
  for (std::size_t i = 0; i < patch.holes.size(); ++i) {
    HoleOutcome& hole = report.outcomes[patch.holes[i]];
    const auto& cells = patch.cells_by_origin[i];
    hole = {cells[0],          cells[1],       cells[2],
            cells[3],          patch.guide[i], patch.rim_error_m[i],
            patch.offset_m[i], patch.seconds,  plan.windows[patch.window].box.cells()};
    report.left += hole.left_cells;
    report.filled += hole.method_cells + hole.guide_cells + hole.water_cells;
    report.water_cells += hole.water_cells;
    report.guide_cells += hole.guide_cells;
  }
  if (plan.windows.size() == 1) report.figures = patch.report;
  report.contour_lines = report.contour_lines || patch.contour_lines;
}

/// Heights go straight to their place in a DEM. Others still look at its mask, so that is changed
/// in the end only.
class DemStore : public FillStore {
 public:
  DemStore(HoleFill& out, bool sigma) : out_(out) {
    const Size size = out.dem.size();
    if (sigma) out.sigma = Raster<float>(size);
    out.origin = Raster<std::uint8_t>(size);
    std::ranges::transform(out.dem.known.cells(), out.origin.cells().begin(), [](auto known) {
      return std::uint8_t(known ? CellOrigin::measured : CellOrigin::left);
    });
  }

  bool has(std::size_t) const override { return false; }
  const std::vector<HolePatch>& done() const override { return none_; }

  void add(const HolePatch& patch) override {
    std::size_t cell = 0;
    for (const CellRun& cells : patch.runs)
      for (int col = cells.begin; col < cells.end; ++col, ++cell) {
        out_.origin(col, cells.row) = std::uint8_t(patch.origin[cell]);
        if (patch.origin[cell] == CellOrigin::left) continue;
        out_.dem.z(col, cells.row) = patch.z[cell];
        if (!patch.sigma.empty() && !out_.sigma.empty())
          out_.sigma(col, cells.row) = patch.sigma[cell];
      }
  }

  /// The filled cells are known.
  void close() {
    const auto known = out_.dem.known.cells();
    for (std::size_t i = 0; i < known.size(); ++i)
      if (out_.origin.cells()[i] != std::uint8_t(CellOrigin::left)) known[i] = 1;
  }

 private:
  HoleFill& out_;
  std::vector<HolePatch> none_;
};

}  // namespace

FillOptions checked(FillOptions options) {
  if (!options.method.method) options.method = find_method(fill_methods(), default_fill_method());
  check(options.holes);
  const auto is_sigma = [](const auto& setting) { return setting.first == "sigma"; };
  const FillMethod& method = *options.method.method;
  if (options.sigma && method.has_setting("sigma") &&
      std::ranges::none_of(options.method.settings, is_sigma))
    options.method.settings.emplace_back("sigma", "law");
  const bool gives = options.method.gives_sigma();
  if (options.sigma && !gives)
    throw std::invalid_argument(
        fmt::format("sigma: method {} gives no standard error", method.name));
  options.sigma = gives;
  return options;
}

LatticeOrigin lattice_origin(const GeoRef& ref) {
  const auto& at = ref.to_world;
  const auto index = [](double position, double step) {
    const double cells = step != 0 ? position / step : 0;
    return std::abs(cells) < 1e15 ? std::int64_t(std::floor(cells + 0.5)) : 0;
  };
  return {index(at[0], at[1]), index(at[3], at[5])};
}

FillPlan plan_fill(std::vector<Hole> holes, Size raster, LatticeOrigin origin,
                   const FillOptions& options, bool in_region) {
  FillPlan plan{std::move(holes), {}, {}, false};
  plan.verdicts = judge(options.holes, plan.holes, in_region);
  std::vector<std::uint8_t> chosen;
  std::size_t cells = 0;
  for (std::size_t h = 0; h < plan.holes.size(); ++h) {
    chosen.push_back(plan.verdicts[h] == Verdict::fill);
    if (chosen.back()) cells += plan.holes[h].cells;
  }
  plan.whole = options.whole || double(cells) > whole_share * double(raster.cells());
  if (plan.whole && cells > 0) {
    plan.windows = {{{0, 0, raster.cols, raster.rows}, {}}};
    for (std::uint32_t h = 0; h < plan.holes.size(); ++h)
      if (chosen[h]) plan.windows[0].holes.push_back(h);
  } else {
    plan.windows = plan_windows(plan.holes, chosen, raster, origin);
  }
  return plan;
}

FillReport report_of(const FillPlan& plan, WindowRange range) {
  FillReport report;
  report.windows = std::min(range.end, plan.windows.size()) - range.first;
  report.outcomes.assign(plan.holes.size(), {0, 0, 0, 0, -1, NAN, NAN, 0, 0});
  for (std::size_t h = 0; h < plan.holes.size(); ++h) {
    const Hole& hole = plan.holes[h];
    const Verdict verdict = plan.verdicts[h];
    report.unknown += hole.cells;
    report.border_holes += hole.at_border;
    if (hole.at_border) report.border_cells += hole.cells;
    if (verdict == Verdict::inner_only) {
      report.left_at_border += hole.cells;
    } else if (verdict == Verdict::memory) {
      report.outcomes[h].left_cells = hole.cells;
      report.left += hole.cells;
    } else if (verdict != Verdict::fill) {
      report.left_by_choice += hole.cells;
    }
  }
  return report;
}

FillReport fill_plan(const FillRaster& raster, const FillPlan& plan, WindowRange range,
                     const FillOptions& options, const FillLayers& layers, FillStore& store,
                     std::size_t memory_cells, const Run& run) {
  range.end = std::min(range.end, plan.windows.size());
  FillReport report = report_of(plan, range);
  for (const HolePatch& entry : store.done()) account(entry, plan, report);
  std::vector<HoleWindow> windows;
  std::vector<std::size_t> numbers;
  for (std::size_t w = range.first; w < range.end; ++w)
    if (store.has(w)) {
      ++report.resumed_windows;
    } else {
      windows.push_back(plan.windows[w]);
      numbers.push_back(w);
    }

  std::vector<methods::GuideSums> sums(layers.guides.size());
  HoleWork work;
  work.flat_water = !plan.whole;
  work.rim_errors = options.rim_errors;
  work.memory_cells = memory_cells;
  work.fill = [&](const Dem& dem, const Run& part) {
    return options.method.method->fill(dem, options.method.settings, part);
  };
  work.read = [&](const Box& box) {
    WindowData data{raster.read(box), {}, {}};
    if (layers.water) data.water = layers.water(box);
    for (std::size_t k = 0; k < layers.guides.size(); ++k)
      sums[k].add(data.dem, data.guides.emplace_back(layers.guides[k].read(box)));
    return data;
  };
  work.take = [&](HolePatch&& patch) {
    patch.window = numbers[patch.window];
    account(patch, plan, report);
    report.window_seconds += patch.seconds;
    store.add(patch);
  };
  const auto start = std::chrono::steady_clock::now();
  fill_windows(plan.holes, windows, work, run);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (std::size_t k = 0; k < sums.size(); ++k)
    report.guides.push_back(sums[k].fit(layers.guides[k].name));
  return report;
}

HoleFill fill_holes(Dem dem, const FillOptions& options, const FillLayers& layers, const Run& run) {
  check_fillable(dem);
  const FillOptions ready = checked(options);
  const Size size = dem.size();
  const std::vector<Spacing> spacing = spacing_of_rows(dem);
  const Mask region = layers.region ? layers.region({0, 0, size.cols, size.rows}) : Mask();
  HoleFill out;
  out.plan = plan_fill(find_holes(dem, spacing, region), size, lattice_origin(dem.ref), ready,
                       bool(layers.region));
  const std::uint64_t before = known_checksum(dem);
  out.dem = std::move(dem);

  DemStore store(out, ready.sigma);
  const FillRaster raster{size, lattice_origin(out.dem.ref), [&](const Box& box) {
                            return crop(out.dem, box, spacing[std::size_t(box.row + box.rows / 2)]);
                          }};
  out.report = fill_plan(raster, out.plan, {}, ready, layers, store, std::size_t(-1), run);
  out.report.known_checksum = before;
  out.report.known_kept = known_checksum(out.dem) == before;
  store.close();
  return out;
}

}  // namespace dem
