#include "report/fill_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "dem/breakdown.h"
#include "dem/evaluate.h"
#include "dem/io/geodesy.h"
#include "report/pictures.h"

namespace dem::app {
namespace {

constexpr Rgb kPaleVoid{250, 226, 214};
constexpr Rgb kLeft{30, 30, 34};
constexpr std::size_t kHolesShown = 12;
constexpr int kThumbnailSide = 168;  // twice what is shown, for fine screens

const std::vector<KeyEntry> kOriginKey{{"measured", {190, 190, 186}},
                                       {"filled by the method", {226, 128, 42}},
                                       {"over an auxiliary DEM", {92, 156, 66}},
                                       {"water, flat", {50, 110, 196}},
                                       {"left void", kLeft}};

/// Classes of sigma, in metres.
const std::vector<double> kSigmaBounds{0,  0.1, 0.2, 0.5, 1,   2,   3,   5,   7,   10,   15,
                                       20, 30,  50,  70,  100, 150, 200, 300, 500, 1000, INFINITY};

/// A box of the filled raster at the size of a picture.
struct View {
  Spacing pixel;
  int k = 1;  // cells on the side of a pixel
  Means z, sigma;
  std::array<Shares, 5> origins;              // how much of each pixel
  std::vector<std::size_t> cells_by_sigma{};  // of kSigmaBounds
  Raster<float> surface{};                    // heights without gaps

  double share(CellOrigin origin, int col, int row) const {
    return origins[std::size_t(origin)].share(col, row);
  }
};

void add_sigma(View& view, const FilledPart& part, int row) {
  Mask told(part.sigma.size());
  for (std::size_t i = 0; i < told.cells().size(); ++i) {
    const double sigma = double(part.sigma.cells()[i]);
    told.cells()[i] = sigma > 0;
    if (sigma > 0)
      ++view.cells_by_sigma[std::size_t(std::ranges::upper_bound(kSigmaBounds, sigma) -
                                        kSigmaBounds.begin() - 1)];
  }
  view.sigma.add(row, part.sigma, told);
}

/// Reads a box strip by strip, so that no more than a few rows of cells are held.
View view_of(const Box& box, Spacing cell, int side, FillJob& job, const Run& run) {
  View view;
  view.k = cells_per_pixel(box.size(), side);
  view.pixel = {cell.dx_m * view.k, cell.dy_m * view.k};
  view.z = view.sigma = Means(box.size(), view.k);
  view.origins.fill(Shares(box.size(), view.k));
  view.cells_by_sigma.resize(kSigmaBounds.size() - 1);
  const int strip = std::max(1, (1 << 20) / box.cols);
  for (int row = 0; row < box.rows; row += strip) {
    run.report(double(row) / box.rows, "report");
    const FilledPart part =
        job.read({box.col, box.row + row, box.cols, std::min(strip, box.rows - row)});
    view.z.add(row, part.dem.z, part.dem.known);
    for (std::size_t o = 0; o < view.origins.size(); ++o)
      view.origins[o].add(row, part.origin, std::uint8_t(o));
    if (!part.sigma.empty()) add_sigma(view, part, row);
  }
  view.surface = view.z.surface();
  return view;
}

struct BeforeAfter {
  Picture before, after;
  Raster<std::uint8_t> shade;
};

/// `sparse`: few cells are known; they are drawn dark on pale, to be seen.
BeforeAfter shaded(const View& view, const HillshadeOptions& light, bool sparse = false) {
  BeforeAfter both{{"before", "Hillshade before filling, holes in red", {}},
                   {"after", "Hillshade after filling", {}},
                   hillshade(view.surface, view.pixel, light)};
  both.before.pixels = both.after.pixels = Raster<Rgb>(view.z.size());
  for (int row = 0; row < view.z.size().rows; ++row)
    for (int col = 0; col < view.z.size().cols; ++col) {
      const Rgb ground = grey(both.shade(col, row));
      const double known = view.share(CellOrigin::measured, col, row);
      both.before.pixels(col, row) = sparse ? mixed(kPaleVoid, mixed(ground, grey(0), 0.7), known)
                                            : mixed(kVoid, ground, known);
      both.after.pixels(col, row) = mixed(ground, kVoid, view.share(CellOrigin::left, col, row));
    }
  return both;
}

/// Which origins there are.
std::array<bool, 5> origins_in(const View& view) {
  std::array<bool, 5> there{};
  for (std::size_t o = 0; o < there.size(); ++o)
    for (int row = 0; row < view.z.size().rows; ++row)
      for (int col = 0; col < view.z.size().cols; ++col) there[o] |= view.origins[o].any(col, row);
  return there;
}

Json origin_map(const View& view, const Raster<std::uint8_t>& shade) {
  Raster<Rgb> picture(shade.size());
  const auto there = origins_in(view);
  for (int row = 0; row < shade.rows(); ++row)
    for (int col = 0; col < shade.cols(); ++col) {
      Colour sum{};
      for (std::size_t o = 0; o < there.size(); ++o) {
        const double share = view.origins[o].share(col, row);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += share * kOriginKey[o].colour[c];
      }
      const Rgb colour{std::uint8_t(sum[0]), std::uint8_t(sum[1]), std::uint8_t(sum[2])};
      picture(col, row) = mixed(colour, grey(shade(col, row)), 0.25);
    }
  std::vector<KeyEntry> key;
  for (std::size_t o = 0; o < there.size(); ++o)
    if (there[o]) key.push_back({kOriginKey[o].name, mixed(kOriginKey[o].colour, grey(180), 0.25)});
  return map_section("Where heights come from", "In the same light.",
                     {"", "Map of where each height comes from", std::move(picture)}, view.pixel,
                     key);
}

Json sigma_map(const View& view, const Raster<std::uint8_t>& shade) {
  const Size size = shade.size();
  Raster<float> means(size);
  Mask told(size);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col)
      if (view.sigma.any(col, row)) means(col, row) = view.sigma.mean(col, row), told(col, row) = 1;
  const double parts[] = {0.99};
  const double high = round_up(quantiles(means, told, parts)[0]);
  Raster<Rgb> picture(size);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      const Rgb ground = mixed(grey(shade(col, row)), grey(255), 0.5);
      const Rgb colour = colour_at(kSigmaRamp, double(means(col, row)) / high);
      picture(col, row) = mixed(mixed(ground, colour, view.sigma.share(col, row)), kLeft,
                                view.share(CellOrigin::left, col, row));
    }
  return map_section(
      "How sure the filled cells are",
      "Standard deviation of each filled cell; grey is measured, black left void. The "
      "scale holds 99 % of the filled cells.",
      {"", "Map of the standard deviation", std::move(picture)}, view.pixel, kSigmaRamp, 0, high,
      "m");
}

Json sigma_bars(const std::vector<std::size_t>& cells) {
  Bars bars;
  bars.title = "Filled cells by standard deviation";
  bars.x_label = "standard deviation, m";
  const auto some = [](std::size_t n) { return n > 0; };
  const auto first = std::ranges::find_if(cells, some) - cells.begin();
  const auto last = std::ranges::find_if(cells.rbegin(), cells.rend(), some).base() - cells.begin();
  for (auto i = std::size_t(first); i < std::size_t(last); ++i) {
    const double from = kSigmaBounds[i], to = kSigmaBounds[i + 1];
    bars.classes.push_back(std::isinf(to) ? fmt::format("> {:g}", from)
                                          : fmt::format("{:g}–{:g}", from, to));
    bars.counts.push_back(cells[i]);
  }
  return bars_section(bars);
}

/// How a hole was filled, in words.
std::string filled_by(const FillJob& job, std::size_t number, const std::string& method) {
  const Verdict verdict = job.plan().verdicts[number];
  if (verdict != Verdict::fill) return "left: " + option_of(name_of(verdict));
  const HoleOutcome& hole = job.report().outcomes[number];
  std::vector<std::string> ways;
  if (hole.method_cells) ways.push_back(method);
  if (hole.guide_cells)
    ways.push_back("over " + name_of(job.report().guides[std::size_t(hole.guide)].name));
  if (hole.water_cells) ways.push_back("flat, as water");
  if (hole.left_cells) ways.push_back(fmt::format("{} cells left", grouped(hole.left_cells)));
  return fmt::format("{}", fmt::join(ways, "; "));
}

/// The hole and some ground around it.
Box surroundings(const Hole& hole, Size raster) {
  const int margin = std::max(8, std::max(hole.box.cols, hole.box.rows) / 4);
  const int left = std::max(0, hole.box.col - margin), top = std::max(0, hole.box.row - margin);
  return {left, top, std::min(raster.cols, hole.box.col + hole.box.cols + margin) - left,
          std::min(raster.rows, hole.box.row + hole.box.rows + margin) - top};
}

Json hole_section(FillJob& job, const std::string& method, std::span<const Spacing> spacing,
                  const Run& run) {
  const std::vector<Hole>& holes = job.plan().holes;
  const std::vector<HoleOutcome>& outcomes = job.report().outcomes;
  std::vector<std::size_t> order(holes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t h) { return holes[h].cells; });
  const std::size_t shown = std::min(order.size(), kHolesShown);
  const bool rim = std::ranges::any_of(
      outcomes, [](const HoleOutcome& hole) { return std::isfinite(hole.rim_error_m); });
  const bool geographic = is_geographic(job.ref());
  const bool vast = shown > 0 && holes[order[0]].area_m2 > 1e5;
  std::vector<std::string> columns{
      "before, after",    "cells",    vast ? "area, km²" : "area, m²", "farthest from data, m",
      "relief of rim, m", "filled by"};
  if (rim) columns.push_back("error of hidden rim cells, m");
  columns.insert(columns.end(), {"time of its window, s",
                                 geographic ? "longitude, latitude" : "x, y", "column, row"});

  Json rows = Json::array();
  for (std::size_t i = 0; i < shown; ++i) {
    const Hole& hole = holes[order[i]];
    const HoleOutcome& outcome = outcomes[order[i]];
    const Box box = surroundings(hole, job.size());
    const Spacing cell = spacing[std::size_t(box.row + box.rows / 2)];
    const View view = view_of(box, cell, kThumbnailSide, job,
                              run.part(double(i) / double(shown), double(i + 1) / double(shown)));
    const BeforeAfter pictures = shaded(view, report_light(view.surface, view.pixel));
    const auto& w = job.ref().to_world;
    const double col = hole.box.col + (hole.box.cols - 1) / 2.0;
    const double row = hole.box.row + (hole.box.rows - 1) / 2.0;
    Json line{picture_cell({pictures.before, pictures.after}, view.pixel),
              grouped(hole.cells),
              three_digits(hole.area_m2 / (vast ? 1e6 : 1)),
              three_digits(hole.distance_m),
              hole.has_rim ? three_digits(hole.rim_relief_m()) : "",
              filled_by(job, order[i], method)};
    if (rim) line.push_back(three_digits(double(outcome.rim_error_m)));
    line.push_back(job.plan().verdicts[order[i]] == Verdict::fill ? decimal(outcome.seconds, 3)
                                                                  : "");
    line.push_back(fmt::format("{:.{}f}, {:.{}f}", w[0] + w[1] * col + w[2] * row,
                               geographic ? 4 : 0, w[3] + w[4] * col + w[5] * row,
                               geographic ? 4 : 0));
    line.push_back(fmt::format("{}, {}", hole.first_col, hole.box.row));
    rows.push_back(std::move(line));
  }
  std::string note = "The largest first. Red: not known.";
  if (shown < order.size()) {
    std::size_t cells = 0;
    for (std::size_t i = shown; i < order.size(); ++i) cells += holes[order[i]].cells;
    note += fmt::format(" {} smaller ones, {} cells together, are not shown.",
                        grouped(order.size() - shown), grouped(cells));
  }
  return table_section(order.size() == 1 ? "The hole" : "Holes", note, columns, std::move(rows));
}

Json size_section(const std::vector<Hole>& holes) {
  Bars bars;
  bars.title = "Holes by size";
  bars.note = "Below: how many holes each class has.";
  bars.x_label = "cells of a hole";
  bars.y_label = "cells in such holes";
  bars.counts_label = "holes";
  std::size_t largest = 0;
  for (const Hole& hole : holes) largest = std::max(largest, hole.cells);
  std::vector<double> cells;
  bool three = false;
  for (std::size_t from = 1, to = 3; from <= largest; three = !three) {  // 1, 3, 10, 30, 100 ...
    bars.classes.push_back(from < 1000 ? fmt::format("{}–{}", from, to - 1)
                                       : fmt::format("{}k–{}k", from / 1000, to / 1000));
    bars.counts.push_back(0);
    cells.push_back(0);
    for (const Hole& hole : holes)
      if (hole.cells >= from && hole.cells < to) {
        ++bars.counts.back();
        cells.back() += double(hole.cells);
      }
    from = std::exchange(to, three ? 3 * to : from * 10);
  }
  bars.series = {{"cells", cells}};
  return bars_section(bars);
}

Json spectrum_of(const Dem& filled) {
  const Size size = filled.size();
  if (count(filled.known) < size.cells() || size.cols < 16 || size.rows < 16) return {};
  return spectrum_section({{"filled", power_spectrum(filled.z, filled.spacing)}},
                          "Of the whole filled surface. Where it falls more steeply than at the "
                          "left, the surface is smooth.");
}

}  // namespace

Json fill_sections(FillJob& job, const std::string& method, const Run& run) {
  // Pictures.
  const Size size = job.size();
  const auto spacing = spacing_by_row(job.ref(), size);
  const View view = view_of({0, 0, size.cols, size.rows}, spacing[std::size_t(size.rows / 2)],
                            kPictureSide, job, run.part(0, 0.6));
  const HillshadeOptions light = report_light(view.surface, view.pixel);
  const bool sparse = 2 * job.report().unknown > size.cells();
  const BeforeAfter pictures = shaded(view, light, sparse);
  Json sections = Json::array();
  sections.push_back(
      swipe_section("Before and after",
                    std::string(sparse ? "Dark cells are known. " : "Red cells are not known. ") +
                        light_note(light) + pixel_note(view.k),
                    pictures.before, pictures.after, view.pixel));
  const auto there = origins_in(view);
  const bool sigma = std::ranges::any_of(view.cells_by_sigma, [](auto n) { return n > 0; });
  if (!sigma || there[2] || there[3] || there[4])
    sections.push_back(origin_map(view, pictures.shade));
  if (sigma) sections.push_back(sigma_map(view, pictures.shade));

  // Charts.
  if (sigma) sections.push_back(sigma_bars(view.cells_by_sigma));
  if (job.plan().holes.size() > 1) sections.push_back(size_section(job.plan().holes));
  if (job.held())
    if (Json spectrum = spectrum_of(*job.held()); !spectrum.is_null())
      sections.push_back(std::move(spectrum));

  if (!job.plan().holes.empty())
    sections.push_back(hole_section(job, method, spacing, run.part(0.6, 1)));
  return sections;
}

ReportPage fill_page(const std::string& in, const FillJob& job) {
  const FillReport& out = job.report();
  const ChosenMethod& chosen = job.options().method;
  ReportPage page;
  page.title = "Filling " + name_of(in);
  page.lead =
      out.unknown == 0
          ? "All cells were known; the output is a copy."
          : fmt::format(
                "{} of {} unknown cells were filled, in {} hole{}. The known cells "
                "are {}.",
                grouped(out.filled), grouped(out.unknown), grouped(job.plan().holes.size()),
                job.plan().holes.size() == 1 ? "" : "s", out.known_kept ? "unchanged" : "CHANGED");
  page.figures = {{"cells filled", grouped(out.filled)},
                  {"cells left", grouped(out.unknown - out.filled)},
                  {"holes", grouped(job.plan().holes.size())},
                  {"of them at the border", grouped(out.border_holes)},
                  {"time of the filling", fmt::format("{:.3g} s", out.seconds)}};
  page.making = {{"input", in}, {"method", chosen.method->name + ": " + chosen.method->summary}};
  for (const auto& [key, value] : chosen.settings) page.making.emplace_back(key, value);
  for (const auto& fit : out.guides) {
    page.making.emplace_back("auxiliary DEM",
                             fmt::format("{}: {:.1f} m below the raster (median), {:.2f} columns "
                                         "and {:.2f} rows beside it{}",
                                         fit.name, fit.offset_m, fit.shift_cols, fit.shift_rows,
                                         fit.warning.empty() ? "" : "; " + fit.warning));
  }
  for (const auto& f : out.figures)
    page.making.emplace_back(f.name,
                             fmt::format("{:.4g}{}{}", f.value, f.unit.empty() ? "" : " ", f.unit));
  return page;
}

}  // namespace dem::app
