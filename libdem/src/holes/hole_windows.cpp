// Windows for holes, and the work in them.

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include "dem/holes.h"
#include "numeric/parallel.h"
#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

constexpr int least_margin = 6;  // the spline's springs span three cells and bend with a few more
constexpr int small_side = 32, square_side = 64;
constexpr std::size_t side_by_side_cells = 1 << 16;  // larger windows use all threads by themselves

Box hull(const Box& a, const Box& b) {
  const int col = std::min(a.col, b.col), row = std::min(a.row, b.row);
  return {col, row, std::max(a.col + a.cols, b.col + b.cols) - col,
          std::max(a.row + a.rows, b.row + b.rows) - row};
}

Box own_window(const Hole& hole, int distance_cells, Size raster) {
  const int margin = least_margin + distance_cells;
  const Box& box = hole.box;
  const int col = std::max(0, box.col - margin), row = std::max(0, box.row - margin);
  return {col, row, std::min(raster.cols, box.col + box.cols + margin) - col,
          std::min(raster.rows, box.row + box.rows + margin) - row};
}

/// Greatest distance to data in cells, from the hole's own numbers: its area tells the cell.
int distance_in_cells(const Hole& hole) {
  const double side = std::sqrt(hole.area_m2 / double(hole.cells));
  const double cells = side > 0 ? hole.distance_m / side : 0;
  return int(std::ceil(std::min(cells, 1e6)));
}

/// Windows of large holes, to be asked which of them contain another.
class Containers {
 public:
  static constexpr int bucket = 256;

  void add(std::size_t window, const Box& box) {
    for (int y = box.row / bucket; y <= (box.row + box.rows - 1) / bucket; ++y)
      for (int x = box.col / bucket; x <= (box.col + box.cols - 1) / bucket; ++x)
        buckets_[key(x, y)].push_back(window);
  }

  /// The first added that contains the box; or `none`.
  static constexpr std::size_t none = std::size_t(-1);
  std::size_t find(const std::vector<HoleWindow>& windows, const Box& box) const {
    const auto found = buckets_.find(key(box.col / bucket, box.row / bucket));
    if (found == buckets_.end()) return none;
    for (const std::size_t w : found->second)
      if (windows[w].box.contains(box)) return w;
    return none;
  }

 private:
  static std::uint64_t key(int x, int y) {
    return (std::uint64_t(std::uint32_t(y)) << 32) | std::uint32_t(x);
  }
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> buckets_;
};

std::int64_t square_of(std::int64_t cell) {
  return cell >= 0 ? cell / square_side : -((-cell + square_side - 1) / square_side);
}

// ---- The work in one window

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

/// A hole in its window: its cells in cells of the window.
struct Place {
  const Hole* hole;
  std::vector<CellRun> runs;
};

template <class Each>
void for_cells(const std::vector<CellRun>& runs, const Each& each) {
  for (const CellRun& run : runs)
    for (int col = run.begin; col < run.end; ++col) each(col, run.row);
}

/// Calls each(col, row) for the eight neighbours in the raster.
template <class Each>
void for_neighbours(const Mask& mask, int col, int row, const Each& each) {
  for (int y = std::max(0, row - 1); y <= std::min(mask.rows() - 1, row + 1); ++y)
    for (int x = std::max(0, col - 1); x <= std::min(mask.cols() - 1, col + 1); ++x)
      if (x != col || y != row) each(x, y);
}

/// The height that a tenth of the known cells beside the given ones lie below.
double tenth_of_rim(const Dem& dem, const std::vector<std::pair<int, int>>& cells,
                    double otherwise) {
  std::vector<float> heights;
  for (const auto& [col, row] : cells)
    for_neighbours(dem.known, col, row, [&](int x, int y) {
      if (dem.known(x, y)) heights.push_back(dem.z(x, y));
    });
  if (heights.empty()) return otherwise;
  const auto tenth = heights.begin() + std::ptrdiff_t(heights.size() / 10);
  std::ranges::nth_element(heights, tenth);
  return double(*tenth);
}

/// Makes the water cells of a hole known, each connected sheet of them at one level, and marks them
/// in `laid`.
void lay_water(Dem& dem, const Mask& water, const Place& place, Mask& laid) {
  for_cells(place.runs, [&](int col, int row) {
    if (!water(col, row) || laid(col, row)) return;
    std::vector<std::pair<int, int>> sheet{{col, row}};
    laid(col, row) = 1;
    for (std::size_t i = 0; i < sheet.size(); ++i)
      for_neighbours(dem.known, sheet[i].first, sheet[i].second, [&](int x, int y) {
        if (dem.known(x, y) || !water(x, y) || laid(x, y)) return;
        laid(x, y) = 1;
        sheet.emplace_back(x, y);
      });
    const double level = tenth_of_rim(dem, sheet, place.hole->rim_low_m);
    for (const auto& [x, y] : sheet) dem.z(x, y) = float(level);
  });
}

/// Heights less those of the guide, where both are known.
Dem delta(const Dem& dem, const Dem& guide) {
  Dem out = dem;
  const auto z = out.z.cells();
  const auto known = out.known.cells();
  for (std::size_t i = 0; i < z.size(); ++i) {
    known[i] = known[i] && guide.known.cells()[i];
    z[i] = known[i] ? z[i] - guide.z.cells()[i] : 0;
  }
  return out;
}

bool covers(const Dem& guide, const Place& place) {
  bool all = true;
  for_cells(place.runs, [&](int col, int row) { all = all && guide.known(col, row); });
  return all;
}

/// The surface by the method (guide -1) or over a guide; empty when it cannot be had.
Filled surface(const Dem& dem, const WindowData& data, int guide, const HoleWork& work,
               const Run& run) {
  if (guide < 0) return work.fill(dem, run);
  const Dem& under = data.guides[std::size_t(guide)];
  const Dem difference = delta(dem, under);
  if (count(difference.known) == 0) return {};
  Filled filled = work.fill(difference, run);
  const auto z = filled.z.cells();
  for (std::size_t i = 0; i < z.size(); ++i)
    z[i] = under.known.cells()[i] ? z[i] + under.z.cells()[i] : nothing;
  return filled;
}

constexpr std::uint64_t rim_seed = 4;

/// Every other rim cell, by chance of its place in the raster.
bool is_hidden(const Box& box, int col, int row) {
  return random_bits(rim_seed, 0, box.col + col, box.row + row) & 1;
}

Dem with_hidden_rims(const Dem& dem, const Box& box, const std::vector<Place>& places) {
  Dem out = dem;
  for (const Place& place : places)
    for_cells(place.runs, [&](int col, int row) {
      for_neighbours(dem.known, col, row, [&](int x, int y) {
        if (!dem.known(x, y) || !is_hidden(box, x, y)) return;
        out.known(x, y) = 0;
        out.z(x, y) = 0;
      });
    });
  return out;
}

/// RMSE of a surface on the hidden rim of one hole; NaN when nothing was hidden there.
float rim_error(const Dem& dem, const Box& box, const Place& place, const Raster<float>& z) {
  double squares = 0;
  int n = 0;
  for_cells(place.runs, [&](int col, int row) {
    for_neighbours(dem.known, col, row, [&](int x, int y) {
      if (!dem.known(x, y) || !is_hidden(box, x, y)) return;
      squares += std::pow(double(z(x, y)) - double(dem.z(x, y)), 2);
      ++n;
    });
  });
  return n ? float(std::sqrt(squares / n)) : nothing;
}

float mean_offset(const Dem& dem, const Dem& guide, const Place& place) {
  double sum = 0;
  int n = 0;
  for_cells(place.runs, [&](int col, int row) {
    for_neighbours(dem.known, col, row, [&](int x, int y) {
      if (!dem.known(x, y) || !guide.known(x, y)) return;
      sum += double(dem.z(x, y)) - double(guide.z(x, y));
      ++n;
    });
  });
  return n ? float(sum / n) : nothing;
}

/// Chooses a guide for each hole by its hidden rim cells; sets HolePatch::guide and rim_error_m.
void choose_guides(const Dem& dem, const Box& box, const std::vector<Place>& places,
                   const WindowData& data, const HoleWork& work, HolePatch& patch, const Run& run) {
  if (!work.rim_errors && data.guides.empty()) return;
  const Dem hidden = with_hidden_rims(dem, box, places);
  if (count(hidden.known) == 0) return;
  for (int guide = -1; guide < int(data.guides.size()); ++guide) {
    const Filled trial = surface(hidden, data, guide, work, run);
    if (trial.z.empty()) continue;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (guide >= 0 && !covers(data.guides[std::size_t(guide)], places[i])) continue;
      const float error = rim_error(dem, box, places[i], trial.z);
      if (std::isnan(error) || (guide >= 0 && error >= patch.rim_error_m[i])) continue;
      patch.rim_error_m[i] = error;
      patch.guide[i] = guide;
    }
  }
}

/// Copies one hole from a surface into the patch. Beside laid water, the shore stays above it.
void add_cells(const Place& place, const Box& box, const Dem& dem, const Mask& laid,
               const Filled& filled, CellOrigin origin, HolePatch& patch) {
  for_cells(place.runs, [&](int col, int row) {
    const bool water = !laid.empty() && laid(col, row);
    float z = water ? dem.z(col, row) : filled.z(col, row);
    if (!water && !laid.empty())
      for_neighbours(laid, col, row, [&](int x, int y) {
        if (laid(x, y)) z = std::max(z, dem.z(x, y));
      });
    patch.z.push_back(z);
    patch.origin.push_back(water              ? CellOrigin::water
                           : std::isfinite(z) ? origin
                                              : CellOrigin::left);
    if (!filled.sigma.empty()) patch.sigma.push_back(water ? 0 : filled.sigma(col, row));
  });
  for (const CellRun& run : place.runs)
    patch.runs.push_back({run.row + box.row, run.begin + box.col, run.end + box.col});
}

void add_flat(const Place& place, const Box& box, bool sigma, HolePatch& patch) {
  const std::size_t cells = patch.z.size() + place.hole->cells;
  patch.z.resize(cells, float(place.hole->rim_low_m));
  patch.origin.resize(cells, CellOrigin::water);
  if (sigma) patch.sigma.resize(cells, 0);
  for (const CellRun& run : place.runs)
    patch.runs.push_back({run.row + box.row, run.begin + box.col, run.end + box.col});
}

void count_origins(HolePatch& patch) {
  patch.cells_by_origin.assign(patch.holes.size(), {});
  std::size_t run = 0, cell = 0;
  for (std::size_t i = 0; i < patch.holes.size(); ++i)
    for (; run < patch.first_run[i + 1]; ++run)
      for (int n = patch.runs[run].end - patch.runs[run].begin; n > 0; --n)
        ++patch.cells_by_origin[i][std::size_t(patch.origin[cell++]) - 1];
}

/// Fills one window and keeps what lies in its holes.
HolePatch fill_window(const std::vector<Hole>& holes, const HoleWindow& window, WindowData&& data,
                      const HoleWork& work, const Run& run) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t n = window.holes.size();
  HolePatch patch;
  patch.holes = window.holes;
  patch.guide.assign(n, -1);
  patch.rim_error_m.assign(n, nothing);
  patch.offset_m.assign(n, nothing);

  std::vector<FirstCell> first;
  for (const std::uint32_t h : window.holes)
    first.push_back({holes[h].first_col - window.box.col, holes[h].box.row - window.box.row});
  auto cells = cells_of_holes(data.dem.known, first);
  std::vector<Place> places;
  for (std::size_t i = 0; i < n; ++i)
    places.push_back({&holes[window.holes[i]], std::move(cells[i])});
  const auto is_flat = [&](const Place& p) {
    return work.flat_water && HoleWork::is_flat(*p.hole);
  };

  // Water first: from then on it is known.
  Dem& dem = data.dem;
  Mask laid;
  if (!data.water.empty()) {
    laid = Mask(dem.size());
    for (const Place& place : places)
      if (!is_flat(place)) lay_water(dem, data.water, place, laid);
    for (std::size_t i = 0; i < laid.cells().size(); ++i)
      if (laid.cells()[i]) dem.known.cells()[i] = 1;
  }

  std::vector<Filled> surfaces(data.guides.size() + 1);  // without a guide, and over each
  if (!std::ranges::all_of(places, is_flat)) {
    choose_guides(dem, window.box, places, data, work, patch, run);
    for (std::size_t i = 0; i < n; ++i) {
      Filled& filled = surfaces[std::size_t(patch.guide[i] + 1)];
      if (!filled.z.empty()) continue;
      filled = surface(dem, data, patch.guide[i], work, run);
      patch.report.insert(patch.report.end(), filled.report.begin(), filled.report.end());
      patch.contour_lines = patch.contour_lines || filled.contour_lines;
    }
  }
  const bool sigma =
      std::ranges::any_of(surfaces, [](const Filled& f) { return !f.sigma.empty(); });
  for (std::size_t i = 0; i < n; ++i) {
    patch.first_run.push_back(patch.runs.size());
    const int guide = patch.guide[i];
    if (is_flat(places[i])) {
      add_flat(places[i], window.box, sigma, patch);
      continue;
    }
    add_cells(places[i], window.box, dem, laid, surfaces[std::size_t(guide + 1)],
              guide < 0 ? CellOrigin::method : CellOrigin::guide, patch);
    if (guide >= 0)
      patch.offset_m[i] = mean_offset(dem, data.guides[std::size_t(guide)], places[i]);
  }
  patch.first_run.push_back(patch.runs.size());
  count_origins(patch);
  patch.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return patch;
}

}  // namespace

std::vector<HoleWindow> plan_windows(const std::vector<Hole>& holes,
                                     const std::vector<std::uint8_t>& chosen, Size raster,
                                     LatticeOrigin origin) {
  struct Candidate {
    std::uint32_t hole;
    Box box;
  };
  std::vector<Candidate> large, small;
  for (std::uint32_t h = 0; h < holes.size(); ++h) {
    if (!chosen[h]) continue;
    const Box& box = holes[h].box;
    const bool is_small = box.cols <= small_side && box.rows <= small_side;
    (is_small ? small : large)
        .push_back({h, own_window(holes[h], distance_in_cells(holes[h]), raster)});
  }

  // Large windows first, the largest before the others; they keep what lies in them.
  std::ranges::stable_sort(
      large, [](const Candidate& a, const Candidate& b) { return a.box.cells() > b.box.cells(); });
  std::vector<HoleWindow> windows;
  Containers containers;
  for (const Candidate& c : large) {
    const std::size_t w = containers.find(windows, c.box);
    if (w != Containers::none) {
      windows[w].holes.push_back(c.hole);
      continue;
    }
    containers.add(windows.size(), c.box);
    windows.push_back({c.box, {c.hole}});
  }

  // Small ones share a window with their neighbours in a square.
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> squares;
  for (const Candidate& c : small) {
    if (const std::size_t w = containers.find(windows, c.box); w != Containers::none) {
      windows[w].holes.push_back(c.hole);
      continue;
    }
    const Box& box = holes[c.hole].box;
    const auto [at, is_new] = squares.try_emplace(
        {square_of(origin.row + box.row), square_of(origin.col + holes[c.hole].first_col)},
        windows.size());
    if (is_new)
      windows.push_back({c.box, {c.hole}});
    else {
      HoleWindow& window = windows[at->second];
      window.box = hull(window.box, c.box);
      window.holes.push_back(c.hole);
    }
  }

  for (HoleWindow& w : windows) std::ranges::sort(w.holes);
  std::ranges::sort(windows, {}, [](const HoleWindow& w) { return w.holes.front(); });
  return windows;
}

bool HoleWork::is_flat(const Hole& hole) {
  return hole.has_rim && hole.cells >= 4 && hole.rim_relief_m() <= 0.01;
}

void fill_windows(const std::vector<Hole>& holes, const std::vector<HoleWindow>& windows,
                  const HoleWork& work, const Run& run) {
  std::size_t all_cells = 0, done_cells = 0;
  for (const HoleWindow& w : windows) all_cells += w.box.cells();
  const auto part_done = [&] { return double(done_cells) / double(all_cells); };
  constexpr std::size_t batch_cells = 1 << 20;

  for (std::size_t next = 0; next < windows.size();) {
    run.report(part_done(), "filling holes");
    const std::size_t first = next;
    if (windows[first].box.cells() > side_by_side_cells) {
      const double from = part_done();
      done_cells += windows[first].box.cells();
      HolePatch patch = fill_window(holes, windows[first], work.read(windows[first].box), work,
                                    run.part(from, part_done()));
      patch.window = first;
      work.take(std::move(patch));
      ++next;
      continue;
    }

    // As many small ones as fit, read one after another and filled side by side.
    std::vector<WindowData> parts;
    for (std::size_t cells = 0; next < windows.size(); ++next) {
      const Box& box = windows[next].box;
      cells += box.cells();
      if (box.cells() > side_by_side_cells ||
          (next > first && cells > std::min(batch_cells, work.memory_cells)))
        break;
      parts.push_back(work.read(box));
      done_cells += box.cells();
    }
    std::vector<HolePatch> patches(parts.size());
    with_threads(run.threads, [&] {
      parallel_for(0, int(parts.size()), 1, [&](int i) {
        const auto k = std::size_t(i);
        patches[k] = fill_window(holes, windows[first + k], std::move(parts[k]), work, {1, {}});
        patches[k].window = first + k;
      });
    });
    for (HolePatch& patch : patches) work.take(std::move(patch));
  }
  run.report(1, "filling holes");
}

std::uint64_t known_checksum(int row, std::span<const std::uint8_t> known,
                             std::span<const float> z) {
  std::uint64_t sum = 0;
  const std::uint64_t row_bits = mix(std::uint64_t(row) + 1);
  for (std::size_t col = 0; col < z.size(); ++col)
    if (known[col])
      sum += mix(row_bits ^ (std::uint64_t(col) << 32) ^ std::bit_cast<std::uint32_t>(z[col]));
  return sum;
}

std::uint64_t known_checksum(const Dem& dem) {
  std::uint64_t sum = 0;
  for (int row = 0; row < dem.size().rows; ++row)
    sum += known_checksum(row, dem.known.row(row), dem.z.row(row));
  return sum;
}

}  // namespace dem
