#include "dem/contours.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "dem/breaklines.h"
#include "dem/spline.h"
#include "numeric/lie_together.h"
#include "numeric/parallel.h"

namespace dem {
using namespace numeric;
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// More levels than this are no contour lines but scattered elevations.
constexpr std::size_t most_levels = 4096;

/// Known cells are contour lines when they are fewer than this part of all, lie along lines, and at
/// least this part of the unknown cells lies in areas of so many cells beside one level or two.
constexpr double most_known = 0.75, least_between = 0.06;
constexpr std::size_t smallest_area = 20;

/// Cells of a line lie up to half a cell off it: noise of their elevation, over the springs' scale.
constexpr double line_noise = 0.7;

/// The same for heights that were moved to the cells' centres.
constexpr double centre_noise = 0.02;

/// The part of its rounded flank that a hill beyond the last line keeps at least.
constexpr double flank_kept = 0.4;

/// The part of the way to the next level that a hill beyond the last line may take.
constexpr double most_of_step = 0.95;

struct Step {
  int dx, dy, length;  // fifths of a cell
};
constexpr std::array<Step, 8> around{Step{1, 0, 5},  Step{-1, 0, 5}, Step{0, 1, 5},
                                     Step{0, -1, 5}, Step{1, 1, 7},  Step{1, -1, 7},
                                     Step{-1, 1, 7}, Step{-1, -1, 7}};

/// Unknown cells that hang together, and the levels beside them.
struct Area {
  std::size_t cells = 0;
  int levels = 0;  // 0, 1, 2, or 3 for more
  float low = 0, high = 0;
  // One level only: what lies beyond its line.
  double slope_below = 0, slope_above = 0;  // sums over the votes
  std::size_t votes_below = 0, votes_above = 0;
  int widest = 0;  // greatest distance to the line, in fifths

  void see(float level) {
    if (levels == 0) low = high = level, levels = 1;
    if (levels == 1 && level != low) {
      low = std::min(low, level), high = std::max(high, level), levels = 2;
    } else if (levels == 2 && level != low && level != high) {
      levels = 3;
    }
  }
  bool between() const { return levels == 2; }
  bool is_hill() const { return levels == 1 && votes_below > 0 && votes_above == 0; }
  bool is_pit() const { return levels == 1 && votes_above > 0 && votes_below == 0; }
};

std::vector<float> levels_of(const Dem& dem) {
  std::vector<float> levels;
  float last = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i) {
    const float z = dem.z.cells()[i];
    if (!dem.known.cells()[i] || z == last) continue;
    last = z;
    const auto at = std::ranges::lower_bound(levels, z);
    if (at != levels.end() && *at == z) continue;
    levels.insert(at, z);
    if (levels.size() > most_levels) return {};
  }
  return levels;
}

class Map {
 public:
  explicit Map(const Dem& dem) : dem_(dem), area_of_(dem.size(), -1) {}

  const std::vector<Area>& areas() const { return areas_; }
  const Area& area(int col, int row) const { return areas_[std::size_t(area_of_(col, row))]; }

  /// Floods the areas.
  void find_areas() {
    std::vector<std::pair<int, int>> waiting;
    for (int row = 0; row < dem_.size().rows; ++row)
      for (int col = 0; col < dem_.size().cols; ++col) {
        if (dem_.known(col, row) || area_of_(col, row) >= 0) continue;
        const int id = int(areas_.size());
        Area area;
        waiting.assign(1, {col, row});
        area_of_(col, row) = id;
        while (!waiting.empty()) {
          const auto [x, y] = waiting.back();
          waiting.pop_back();
          ++area.cells;
          for (const Step& s : around) {
            const int nx = x + s.dx, ny = y + s.dy;
            if (!area_of_.contains(nx, ny) || is_parted(x, y, s)) continue;
            if (dem_.known(nx, ny)) {
              area.see(dem_.z(nx, ny));
            } else if (s.length == 5 && area_of_(nx, ny) < 0) {
              area_of_(nx, ny) = id;
              waiting.emplace_back(nx, ny);
            }
          }
        }
        areas_.push_back(area);
      }
  }

  /// Distances, in fifths of a cell and within the area, of the cells of areas that are wanted to
  /// the line with the area's low (else high) level; -1: none.
  Raster<int> distances(bool to_low) const {
    Raster<int> distance(dem_.size(), -1);
    // Dial's buckets: the distances at hand span less than eight.
    std::array<std::vector<std::pair<int, int>>, 8> buckets;
    std::size_t open = 0;
    for (int row = 0; row < dem_.size().rows; ++row)
      for (int col = 0; col < dem_.size().cols; ++col) {
        if (dem_.known(col, row)) continue;
        const Area& a = area(col, row);
        if (a.levels == 0 || a.levels > 2) continue;
        const float level = to_low ? a.low : a.high;
        int nearest = 0;
        for (const Step& s : around) {
          const int x = col + s.dx, y = row + s.dy;
          if (dem_.known.contains(x, y) && dem_.known(x, y) && dem_.z(x, y) == level)
            nearest = nearest == 0 ? s.length : std::min(nearest, s.length);
        }
        if (nearest == 0) continue;
        distance(col, row) = nearest;
        buckets[std::size_t(nearest)].emplace_back(col, row);
        ++open;
      }
    for (int d = 0; open > 0; ++d) {
      auto& bucket = buckets[std::size_t(d % 8)];
      for (std::size_t i = 0; i < bucket.size(); ++i) {
        const auto [col, row] = bucket[i];
        --open;
        if (distance(col, row) != d) continue;
        for (const Step& s : around) {
          const int x = col + s.dx, y = row + s.dy;
          if (!area_of_.contains(x, y) || area_of_(x, y) != area_of_(col, row)) continue;
          if (distance(x, y) >= 0 && distance(x, y) <= d + s.length) continue;
          distance(x, y) = d + s.length;
          buckets[std::size_t((d + s.length) % 8)].emplace_back(x, y);
          ++open;
        }
      }
      bucket.clear();
    }
    return distance;
  }

  /// Areas beside one level learn what lies beyond their line.
  void look_beyond(const Raster<int>& to_low, const Raster<int>& to_high) {
    for (int row = 0; row < dem_.size().rows; ++row)
      for (int col = 0; col < dem_.size().cols; ++col) {
        if (!dem_.known(col, row)) {
          Area& a = areas_[std::size_t(area_of_(col, row))];
          a.widest = std::max(a.widest, to_low(col, row));
          continue;
        }
        for (const Step& s : around)
          if (area_of_.contains(col + s.dx, row + s.dy))
            vote(col, row, col + s.dx, row + s.dy, to_low, to_high);
      }
  }

 private:
  /// A line's cell at (col, row) with an area of its level alone at (x, y): what do the other cells
  /// around belong to?
  void vote(int col, int row, int x, int y, const Raster<int>& to_low, const Raster<int>& to_high) {
    if (dem_.known(x, y)) return;
    Area& a = areas_[std::size_t(area_of_(x, y))];
    const float level = dem_.z(col, row);
    if (a.levels != 1 || a.low != level) return;
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) {
        const int u = col + dx, v = row + dy;
        if (!area_of_.contains(u, v) || area_of_(u, v) == area_of_(x, y)) continue;
        if (dem_.known(u, v)) {  // lines side by side
          const float other = dem_.z(u, v);
          const double steep = std::abs(double(other) - double(level)) / std::hypot(dx, dy);
          if (other < level) a.slope_below += steep, ++a.votes_below;
          if (other > level) a.slope_above += steep, ++a.votes_above;
          continue;
        }
        const Area& b = area(u, v);
        const int way = to_low(u, v) + to_high(u, v);
        if (!b.between() || to_low(u, v) < 0 || to_high(u, v) < 0) continue;
        const double slope = 5 * (double(b.high) - double(b.low)) / way;
        if (b.high == level) a.slope_below += slope, ++a.votes_below;
        if (b.low == level) a.slope_above += slope, ++a.votes_above;
      }
  }

  /// Whether a breakline passes between a cell and its neighbour.
  bool is_parted(int x, int y, const Step& s) const {
    return is_broken(dem_.breaks, std::min(x, x + s.dx), std::min(y, y + s.dy), 1 + std::abs(s.dx),
                     1 + std::abs(s.dy));
  }

  const Dem& dem_;
  Raster<int> area_of_;
  std::vector<Area> areas_;
};

bool are_contour_lines(const Dem& dem, const std::vector<Area>& areas) {
  const double cells = double(dem.size().cells()), known = double(count(dem.known));
  if (known > most_known * cells || !lie_together(dem.known)) return false;
  double between = 0;
  for (const Area& a : areas)
    if (a.cells >= smallest_area && (a.levels == 1 || a.levels == 2)) between += double(a.cells);
  return between >= least_between * (cells - known);
}

/// How far a flank of this slope (metres a cell) rises at distance d beyond its line, when it
/// rounds off to level ground at distance `widest`: a parabola, cut at `most`. Distances in fifths.
double rounded_rise(double slope, int d, int widest, double most) {
  const double x = d / 5., w = std::max(1., widest / 5.);
  const double rise = slope * (x - x * x / (2 * w)), top = slope * w / 2;
  return top > most ? rise * most / top : rise;
}

}  // namespace

std::vector<Field> fields(ContourOptions& o) {
  return {{"least_slope",
           o.least_slope,
           {0, 0.9},
           "",
           "part of the straight slope between lines that is always kept"},
          {"rounds", o.rounds, {0, 100}, "", "solves after the first, with cells held on bounds"}};
}

ContourBounds contour_bounds(const Dem& dem, const ContourOptions& options, const Run& run) {
  check_shape(dem);
  check_options(options);
  const Size size = dem.size();
  ContourBounds out{false, Raster<float>(size, -infinite), Raster<float>(size, infinite)};
  const std::vector<float> levels = levels_of(dem);
  if (levels.size() < 2) return out;
  Map map(dem);
  run.report(0, "areas between contour lines");
  map.find_areas();
  if (!are_contour_lines(dem, map.areas())) return out;
  out.lines = true;
  run.report(0.3, "areas between contour lines");
  const Raster<int> to_low = map.distances(true), to_high = map.distances(false);
  map.look_beyond(to_low, to_high);
  for (const Area& a : map.areas()) {
    if (a.between()) out.between += a.cells;
    out.domes += a.is_hill();
    out.pits += a.is_pit();
  }
  // The distance from a level to the next, upwards or downwards; at the ends: as inwards.
  const auto step_from = [&](float level, bool up) {
    const auto at = std::ranges::lower_bound(levels, level);
    if (up ? at + 1 != levels.end() : at == levels.begin()) return double(at[1]) - double(*at);
    return double(*at) - double(at[-1]);
  };
  const double kept = options.least_slope;
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      float &lower = out.lower(col, row), &upper = out.upper(col, row);
      if (dem.known(col, row)) {
        lower = upper = dem.z(col, row);
        continue;
      }
      const Area& a = map.area(col, row);
      const int d = to_low(col, row), e = to_high(col, row);
      if (a.between() && d >= 0 && e >= 0) {
        const double rise = double(a.high) - double(a.low), t = double(d) / (d + e);
        lower = float(double(a.low) + kept * rise * t);
        upper = float(double(a.high) - kept * rise * (1 - t));
      } else if (a.is_hill()) {
        const double most = most_of_step * step_from(a.low, true);
        const double slope = a.slope_below / double(a.votes_below);
        lower = float(double(a.low) + flank_kept * rounded_rise(slope, d, a.widest, most));
        upper = float(double(a.low) + most);
      } else if (a.is_pit()) {
        const double most = most_of_step * step_from(a.low, false);
        const double slope = a.slope_above / double(a.votes_above);
        lower = float(double(a.low) - most);
        upper = float(double(a.low) - flank_kept * rounded_rise(slope, d, a.widest, most));
      }
    }
  return out;
}

namespace {

float outside_by(float z, float lower, float upper) {
  return z < lower ? lower - z : z > upper ? z - upper : 0;
}

/// Holds the worst cell of each neighbourhood of 5 x 5 on its bound; returns how many.
std::size_t hold_worst(const Raster<float>& z, const ContourBounds& bounds, Dem& held,
                       Raster<float>& noise) {
  const Size size = z.size();
  Raster<float> outside(size);
  for (std::size_t i = 0; i < z.cells().size(); ++i)
    outside.cells()[i] = outside_by(z.cells()[i], bounds.lower.cells()[i], bounds.upper.cells()[i]);
  std::size_t n = 0;
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      const float here = outside(col, row);
      if (here <= 0 || held.known(col, row)) continue;
      bool worst = true;
      for (int y = std::max(0, row - 2); y <= std::min(size.rows - 1, row + 2); ++y)
        for (int x = std::max(0, col - 2); x <= std::min(size.cols - 1, col + 2); ++x) {
          const bool before = y < row || (y == row && x < col);
          worst = worst && (outside(x, y) < here || (outside(x, y) == here && !before) ||
                            (x == col && y == row));
        }
      if (!worst) continue;
      held.known(col, row) = 1;
      noise(col, row) = 0;
      held.z(col, row) = std::clamp(z(col, row), bounds.lower(col, row), bounds.upper(col, row));
      ++n;
    }
  return n;
}

/// The surface through the known cells of `dem` and within bounds. `nugget`: noise of those cells.
Filled fill_within(const Dem& dem, const ContourBounds& bounds, double nugget,
                   const ContourOptions& options, const Run& run) {
  const double parts = bounds.lines ? options.rounds + 1. : 1;
  SplineFilled filled = fill_spline(dem, SplineOptions{}, run.part(0, 1 / parts));
  filled.contour_lines = bounds.lines;
  filled.report.push_back({"contour_lines", bounds.lines ? 1. : 0., ""});
  if (!bounds.lines) return filled;

  // The springs of the first solve. Lines pull; cells held on a bound are met exactly.
  SplineOptions springs;
  springs.parameters = SplineParameters::manual;
  springs.L1_rows = filled.L1_rows;
  springs.L3_rows = filled.L3_rows;
  springs.fourth_order = filled.fourth_order;
  springs.adaptive_sigma_cells = 1.5;
  springs.nugget = nugget;
  Raster<float> noise(dem.size(), 1);
  Dem held = dem;
  std::size_t cells_held = 0, clamped = 0;
  for (int round = 1; round <= options.rounds; ++round) {
    const std::size_t n = hold_worst(filled.z, bounds, held, noise);
    if (n == 0) break;
    cells_held += n;
    filled.z = fill_spline(held, noise, springs, run.part(round / parts, (round + 1) / parts)).z;
  }
  for (std::size_t i = 0; i < filled.z.cells().size(); ++i) {
    float& z = filled.z.cells()[i];
    const float lower = bounds.lower.cells()[i], upper = bounds.upper.cells()[i];
    if (dem.known.cells()[i] || outside_by(z, lower, upper) == 0) continue;
    z = std::clamp(z, lower, upper);
    ++clamped;
  }
  filled.report.push_back({"cells_between_levels", double(bounds.between), ""});
  filled.report.push_back({"hills", double(bounds.domes), ""});
  filled.report.push_back({"pits", double(bounds.pits), ""});
  filled.report.push_back({"cells_held", double(cells_held), ""});
  filled.report.push_back({"cells_clamped", double(clamped), ""});
  return filled;
}

}  // namespace

Filled fill_contours(const Dem& dem, const ContourOptions& options, const Run& run) {
  check_fillable(dem);
  const ContourBounds bounds = contour_bounds(dem, options, run.part(0, 0.1));
  return fill_within(dem, bounds, line_noise, options, run.part(0.1, 1));
}

Filled fill_contours(const Dem& lines, const Raster<float>& at_centres,
                     const ContourOptions& options, const Run& run) {
  check_fillable(lines);
  if (at_centres.size() != lines.size())
    throw std::invalid_argument(fmt::format("at_centres is {} x {}; must be {} x {} as the lines",
                                            at_centres.cols(), at_centres.rows(), lines.size().cols,
                                            lines.size().rows));
  const ContourBounds bounds = contour_bounds(lines, options, run.part(0, 0.1));
  Dem dem = lines;
  dem.z = at_centres;
  return fill_within(dem, bounds, centre_noise, options, run.part(0.1, 1));
}

}  // namespace dem
