#include "spline/spline_parameters.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/breaklines.h"
#include "dem/mcmd.h"
#include "numeric/distance.h"
#include "numeric/lie_together.h"
#include "numeric/parallel.h"
#include "numeric/random.h"
#include "numeric/union_find.h"
#include "spline/spline_solver.h"

namespace dem::spline {
using namespace numeric;
namespace {

constexpr std::uint64_t seed = 20070;
constexpr double none = 512;  // stands for "no membrane" where lengths are compared

// ---- Trials: a part of the DEM with some known cells hidden

struct Hidden {
  int col, row;
  double z;
};

struct Trial {
  int col, row;  // of its first cell
  Dem dem;
  std::vector<Hidden> hidden;
  Grid<double> x;  ///< the surface of the last candidate: the start of the next
  double square_error = 0;
};

struct Candidate {
  double L1, L3;  // 0: none
  bool fourth_order;
  double log2_L1() const { return std::log2(L1 > 0 ? L1 : none); }
};

void hide(Trial& trial, int col, int row) {
  trial.hidden.push_back({col, row, double(trial.dem.z(col, row))});
  trial.dem.known(col, row) = 0;
  trial.dem.z(col, row) = 0;
}

/// The hidden cells' errors as they are now.
std::vector<HeldOut> held_out(const std::vector<Trial>& trials) {
  std::vector<HeldOut> all;
  for (const Trial& t : trials) {
    const auto distance = chamfer_distances(t.dem.known);
    for (const Hidden& h : t.hidden)
      all.push_back({float(t.x.row(h.row)[h.col] - h.z), distance(h.col, h.row), t.col + h.col,
                     t.row + h.row});
  }
  return all;
}

/// Squared error of the hidden cells under one candidate, in every trial.
void try_springs(std::vector<Trial>& trials, const Candidate& candidate, double X) {
  parallel_for(0, int(trials.size()), 1, [&](int t) {
    Trial& trial = trials[std::size_t(t)];
    const Size size = trial.dem.size();
    if (trial.x.empty()) {
      const Raster<float> start = fill_mcmd(trial.dem, {}, {1, {}});
      trial.x = Grid<double>(size);
      for (int y = 0; y < size.rows; ++y) std::ranges::copy(start.row(y), trial.x.row(y));
    }
    Mask free(size);
    const Mask closed = cells_closed_off(trial.dem.known, trial.dem.breaks);
    for (int y = 0; y < size.rows; ++y)
      for (int x = 0; x < size.cols; ++x) free(x, y) = !trial.dem.known(x, y) && !closed(x, y);
    const double L1 = candidate.L1 > 0 ? candidate.L1 : 1000. * (size.cols + size.rows);
    const double two_pi = 2 * std::numbers::pi;
    SplineSolver solver(
        terrain_springs(std::pow(two_pi / L1, 2), 1, std::pow(candidate.L3 / two_pi, 2), X,
                        candidate.fourth_order),
        X, free, {}, trial.dem.breaks);
    solver.solve(trial.x, nullptr, {0, 0.15, 6}, {});
    trial.square_error = 0;
    for (const Hidden& h : trial.hidden)
      trial.square_error += std::pow(trial.x.row(h.row)[h.col] - h.z, 2);
  });
}

// ---- Scattered samples

std::vector<Trial> scattered_trials(const Dem& dem) {
  const Size size = dem.size();
  const double density = double(count(dem.known)) / double(size.cells());
  const std::uint64_t one_in = density < 0.05 ? 5 : 10;
  const Size window{std::min(128, size.cols), std::min(128, size.rows)};
  std::vector<Trial> trials;
  for (int part = 0; part < 4; ++part) {
    // The middle of each quadrant; on a small DEM the windows overlap.
    const int col = std::clamp(size.cols * (1 + 2 * (part % 2)) / 4 - window.cols / 2, 0,
                               size.cols - window.cols);
    const int row = std::clamp(size.rows * (1 + 2 * (part / 2)) / 4 - window.rows / 2, 0,
                               size.rows - window.rows);
    Trial trial{col, row, crop(dem, {col, row, window.cols, window.rows}, dem.spacing), {}, {}, 0};
    for (int y = 0; y < window.rows; ++y)
      for (int x = 0; x < window.cols; ++x)
        if (trial.dem.known(x, y) && random_bits(seed, std::uint64_t(part), x, y) % one_in == 0)
          hide(trial, x, y);
    if (!trial.hidden.empty() && count(trial.dem.known) >= 3) trials.push_back(std::move(trial));
  }
  return trials;
}

ChosenSprings choose_scattered(const Dem& dem, double X, const Run& run) {
  struct Row {
    Candidate springs;
    double step;  // of L3, for the charge
  };
  static constexpr Row rows[] = {
      {{64, 7, true}, 0.5},   {{64, 12, true}, 1},   {{64, 4, true}, 0},   {{64, 0, true}, -1},
      {{64, 0, false}, -1.5}, {{0, 7, true}, 0.5},   {{24, 7, true}, 0.5}, {{12, 0, true}, -1},
      {{12, 0, false}, -1.5}, {{6, 0, false}, -1.5}, {{3, 0, false}, -1.5}};
  ChosenSprings chosen;
  std::vector<Trial> trials = scattered_trials(dem);
  for (const Trial& t : trials) chosen.hidden_cells += int(t.hidden.size());
  if (chosen.hidden_cells < 8) return chosen;
  const double charge = 0.15 / std::sqrt(double(chosen.hidden_cells));
  double best = std::numeric_limits<double>::infinity();
  for (const Row& row : rows) {
    try_springs(trials, row.springs, X);
    double sum = 0;
    for (const Trial& t : trials) sum += t.square_error;
    const double rmse = std::sqrt(sum / chosen.hidden_cells);
    const double score =
        std::log(std::max(rmse, 1e-9)) +
        charge * (std::abs(row.springs.log2_L1() - 6) / 2 + std::abs(row.step - 0.5));
    run.report(double(&row - rows + 1) / std::size(rows), "choosing the springs");
    if (score >= best) continue;
    best = score;
    chosen.L1_rows = row.springs.L1;
    chosen.L3_rows = row.springs.L3;
    chosen.fourth_order = row.springs.fourth_order;
    chosen.hidden_rmse_m = rmse;
    chosen.held_out = held_out(trials);
  }
  return chosen;
}

// ---- Gaps: disks beside them

struct Disk {
  int col, row;
  double radius;
};

/// The local maximum of the distance to data that is reached by climbing from a cell.
Disk climb(const Raster<std::uint16_t>& distance, int col, int row) {
  while (true) {
    int best_col = col, best_row = row;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (distance.contains(col + dx, row + dy) &&
            distance(col + dx, row + dy) > distance(best_col, best_row)) {
          best_col = col + dx;
          best_row = row + dy;
        }
    if (best_col == col && best_row == row) return {col, row, distance(col, row) / 5.};
    col = best_col;
    row = best_row;
  }
}

template <class Each>
void for_disk(const Disk& disk, Size size, const Each& each) {
  const int reach = int(disk.radius);
  for (int y = std::max(0, disk.row - reach); y <= std::min(size.rows - 1, disk.row + reach); ++y)
    for (int x = std::max(0, disk.col - reach); x <= std::min(size.cols - 1, disk.col + reach); ++x)
      if (std::pow(x - disk.col, 2) + std::pow(y - disk.row, 2) <= disk.radius * disk.radius)
        each(x, y);
}

/// A disk's window reaches so many radii, and a rim, to each side.
constexpr double window_rim = 12;
constexpr double window_radii(bool mostly_known) { return mostly_known ? 2 : 3; }

/// Disks as wide as the gaps, two to three radii from their middles.
std::vector<Disk> disks_beside_gaps(const Dem& dem, const Raster<std::uint16_t>& distance,
                                    bool mostly_known) {
  constexpr int most_disks = 48, fewest_disks = 16, tries = 4000;
  const Size size = dem.size();
  std::vector<std::uint32_t> unknown;
  for (std::size_t i = 0; i < size.cells(); ++i)
    if (!dem.known.cells()[i]) unknown.push_back(std::uint32_t(i));
  // Wide gaps stand for themselves with narrower disks, so that enough of them can be afforded.
  const double area_limit = mostly_known ? std::clamp(2. * double(unknown.size()), 60000., 250000.)
                                         : std::clamp(double(size.cells()) / 3, 60000., 500000.);
  const double widest =
      (std::sqrt(area_limit / fewest_disks) - 2 * window_rim) / (2 * window_radii(mostly_known));
  double area = 0;
  std::vector<Disk> disks;
  Sequence random(seed);
  for (int t = 0;
       t < tries && !unknown.empty() && int(disks.size()) < most_disks && area < area_limit; ++t) {
    const std::uint32_t cell = unknown[random.below(unknown.size())];
    Disk disk =
        climb(distance, int(cell % std::uint32_t(size.cols)), int(cell / std::uint32_t(size.cols)));
    disk.radius = std::min(disk.radius, widest);
    // A random offset between two and three radii long, and two cells.
    const double near = 2 * disk.radius + 2, far = 3 * disk.radius + 2;
    const double dx = far * signed_uniform(random.bits()), dy = far * signed_uniform(random.bits());
    const double length2 = dx * dx + dy * dy;
    if (length2 < near * near || length2 > far * far) continue;
    disk.col += int(std::floor(dx + 0.5));
    disk.row += int(std::floor(dy + 0.5));
    if (!distance.contains(disk.col, disk.row)) continue;
    int cells = 0, known = 0;
    for_disk(disk, size, [&](int x, int y) {
      ++cells;
      known += dem.known(x, y);
    });
    if (known == 0 || (mostly_known && known < 0.8 * cells)) continue;
    const bool overlaps = std::ranges::any_of(disks, [&](const Disk& d) {
      return std::pow(d.col - disk.col, 2) + std::pow(d.row - disk.row, 2) <
             std::pow(d.radius + disk.radius, 2);
    });
    if (overlaps) continue;
    disks.push_back(disk);
    area += std::pow(2 * (window_radii(mostly_known) * disk.radius + window_rim), 2);
  }
  return disks;
}

std::vector<Trial> disk_trials(const Dem& dem, const std::vector<Disk>& disks, bool mostly_known) {
  const Size size = dem.size();
  std::vector<Trial> trials;
  for (const Disk& disk : disks) {
    const int half = int(window_radii(mostly_known) * disk.radius + window_rim);
    const int col = std::max(0, disk.col - half), row = std::max(0, disk.row - half);
    const Size window{std::min(size.cols, disk.col + half + 1) - col,
                      std::min(size.rows, disk.row + half + 1) - row};
    Trial trial{col, row, crop(dem, {col, row, window.cols, window.rows}, dem.spacing), {}, {}, 0};
    for_disk(disk, size, [&](int x, int y) {
      if (dem.known(x, y)) hide(trial, x - col, y - row);
    });
    if (count(trial.dem.known) >= 3) trials.push_back(std::move(trial));
  }
  return trials;
}

ChosenSprings choose_clustered(const Dem& dem, const Raster<std::uint16_t>& distance, double X,
                               const Run& run) {
  const bool mostly_known = 2 * count(dem.known) > dem.size().cells();
  const Candidate usual = mostly_known ? Candidate{64, 4, true} : Candidate{64, 0, false};
  const auto step = [](const Candidate& c) { return !c.fourth_order ? 0 : c.L3 < 6 ? 1 : 2; };

  ChosenSprings chosen;
  chosen.layout = Layout::clustered;
  chosen.L1_rows = usual.L1;
  chosen.L3_rows = usual.L3;
  chosen.fourth_order = usual.fourth_order;
  std::vector<Trial> trials =
      disk_trials(dem, disks_beside_gaps(dem, distance, mostly_known), mostly_known);
  for (const Trial& t : trials) chosen.hidden_cells += int(t.hidden.size());
  if (trials.size() < 4) return chosen;

  // Few disks say little: the charge for leaving the usual springs grows as they get fewer.
  const double charge = 0.015 * std::max(1., 24 / double(trials.size()));
  const auto score = [&](const Candidate& c) {
    std::vector<double> errors;
    for (const Trial& t : trials) errors.push_back(t.square_error / double(t.hidden.size()));
    std::vector<double> sorted = errors;
    std::ranges::nth_element(sorted, sorted.begin() + std::ptrdiff_t(sorted.size() / 2));
    const double floor = std::max(0.01 * sorted[sorted.size() / 2], 1e-12);
    double sum = 0;
    for (const double e : errors) sum += std::log(e + floor) / 2;
    return sum / double(errors.size()) +
           charge * (std::abs(c.log2_L1() - usual.log2_L1()) + std::abs(step(c) - step(usual)));
  };
  double best = std::numeric_limits<double>::infinity();
  Candidate best_springs = usual;
  int done = 0;
  const auto attempt = [&](const Candidate& c) {
    try_springs(trials, c, X);
    const double s = score(c);
    run.report(++done / 10., "choosing the springs");
    // Between tracks the trials tell little: only a clear gain counts against the usual springs.
    const bool first = best == std::numeric_limits<double>::infinity();
    const double gain = first || mostly_known || best_springs.L1 != usual.L1 ? 0 : 0.05;
    if (s >= best - gain) return;
    best = s;
    best_springs = c;
    double squares = 0;
    for (const Trial& t : trials) squares += t.square_error;
    chosen.hidden_rmse_m = std::sqrt(squares / chosen.hidden_cells);
    chosen.held_out = held_out(trials);
  };
  for (const double L1 : {64., 128., 0., 32., 16.}) attempt({L1, usual.L3, usual.fourth_order});
  attempt({8, 0, false});
  attempt({4, 0, false});
  const double L1 = best_springs.L1;
  for (const Candidate& c :
       {Candidate{L1, 0, false}, Candidate{L1, 4, true}, Candidate{L1, 9, true}})
    if (c.L3 != usual.L3) attempt(c);
  chosen.L1_rows = best_springs.L1;
  chosen.L3_rows = best_springs.L3;
  chosen.fourth_order = best_springs.fourth_order;
  return chosen;
}

/// Small windows around holes: too little ground to choose from, at more than the cost of the fill.
/// When errors are asked for, the usual springs are tried once.
ChosenSprings usual_beside_holes(const Dem& dem, Layout layout,
                                 const Raster<std::uint16_t>& distance, double X,
                                 bool errors_wanted) {
  constexpr Candidate usual{64, 4, true};
  ChosenSprings chosen;
  chosen.layout = layout;
  chosen.L1_rows = usual.L1;
  chosen.L3_rows = usual.L3;
  chosen.fourth_order = usual.fourth_order;
  chosen.as_usual = true;
  if (!errors_wanted) return chosen;
  std::vector<Trial> trials = disk_trials(dem, disks_beside_gaps(dem, distance, true), true);
  if (trials.size() < 4) return chosen;
  try_springs(trials, usual, X);
  chosen.held_out = held_out(trials);
  return chosen;
}

// ---- Contours

/// The step between contour values: the smallest gap of the distinct known values, when all gaps
/// are multiples of it; else 0. Looks at a sample of the known cells.
double contour_step(const Dem& dem) {
  std::vector<float> values;
  const std::size_t stride = std::max<std::size_t>(1, dem.size().cells() / 400000);
  for (std::size_t i = 0; i < dem.size().cells(); i += stride)
    if (dem.known.cells()[i]) values.push_back(dem.z.cells()[i]);
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() < 3) return 0;
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i)
    step = std::min(step, double(values[i]) - double(values[i - 1]));
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double steps = (double(values[i]) - double(values[i - 1])) / step;
    if (std::abs(steps - std::round(steps)) > 0.05) return 0;
  }
  return step;
}

/// The part of the unknown cells (in runs of 20 and more) whose run has a rim within one step.
double part_between_two_lines(const Dem& dem, double step) {
  const Size size = dem.size();
  UnionFind<std::uint32_t> gaps(size.cells());
  const auto index = [&](int x, int y) {
    return std::uint32_t(y) * std::uint32_t(size.cols) + std::uint32_t(x);
  };
  for (int y = 0; y < size.rows; ++y)
    for (int x = 0; x < size.cols; ++x) {
      if (dem.known(x, y)) continue;
      if (x > 0 && !dem.known(x - 1, y)) gaps.join(index(x, y), index(x - 1, y));
      if (y > 0 && !dem.known(x, y - 1)) gaps.join(index(x, y), index(x, y - 1));
    }
  struct Run {
    float low = std::numeric_limits<float>::infinity(),
          high = -std::numeric_limits<float>::infinity();
    std::uint32_t cells = 0;
  };
  std::vector<Run> runs(size.cells());
  for (int y = 0; y < size.rows; ++y)
    for (int x = 0; x < size.cols; ++x) {
      if (dem.known(x, y)) continue;
      Run& run = runs[gaps.root(index(x, y))];
      ++run.cells;
      constexpr int sides[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
      for (const auto& [dx, dy] : sides)
        if (dem.known.contains(x + dx, y + dy) && dem.known(x + dx, y + dy)) {
          run.low = std::min(run.low, dem.z(x + dx, y + dy));
          run.high = std::max(run.high, dem.z(x + dx, y + dy));
        }
    }
  double between = 0, all = 0;
  for (const Run& run : runs) {
    if (run.cells < 20) continue;
    all += run.cells;
    if (double(run.high) - double(run.low) <= 1.01 * step) between += run.cells;
  }
  return all > 0 ? between / all : 0;
}

}  // namespace

Layout layout_of(const Dem& dem, const Raster<std::uint16_t>& distance) {
  const double cells = double(dem.size().cells()), known = double(count(dem.known));
  if (known == cells) return Layout::scattered;
  const double density = known / cells;
  if (density < 0.75 && lie_together(dem.known))
    if (const double step = contour_step(dem);
        step > 0 && part_between_two_lines(dem, step) >= 0.06)
      return Layout::contours;
  double sum = 0;
  for (const std::uint16_t d : distance.cells()) sum += d;
  const double mean = sum / 5 / (cells - known);
  return mean > 1.5 * std::max(1., 0.5 / std::sqrt(density)) ? Layout::clustered
                                                             : Layout::scattered;
}

ChosenSprings choose_springs(const Dem& dem, Layout layout, const Raster<std::uint16_t>& distance,
                             double X, bool errors_wanted, const Run& run) {
  constexpr std::size_t cells_to_choose_from = 1 << 15;
  const std::size_t cells = dem.size().cells();
  if (cells < cells_to_choose_from && 5 * count(dem.known) >= 3 * cells)
    return usual_beside_holes(dem, layout, distance, X, errors_wanted);
  switch (layout) {
    case Layout::scattered:
      return choose_scattered(dem, X, run);
    case Layout::clustered:
      return choose_clustered(dem, distance, X, run);
    case Layout::contours: {
      // A line is only as exact as the cells it runs through: it pulls as hard as the springs do at
      // a wavelength of 3.5 cells.
      const double K = std::pow(2 * std::numbers::pi / 3.5, 2);
      return {64, 0, true, 1 / (K * K), Layout::contours, 0, 0, {}, contour_step(dem), false};
    }
  }
  return {};
}

}  // namespace dem::spline
