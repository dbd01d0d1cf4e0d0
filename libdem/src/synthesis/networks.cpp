#include "dem/networks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "synthesis/flood.h"
#include "synthesis/growth.h"

namespace dem {
using namespace synthesis;
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr std::array<Cell, 8> around{
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

Skeleton empty_skeleton(Size size, Spacing spacing) {
  return {{Raster<float>(size), Mask(size), {}, spacing}, Raster<CellKind>(size), {}};
}

void put(Skeleton& s, Cell c, CellKind kind, double height_m) {
  s.dem.z(c.col, c.row) = float(height_m);
  s.dem.known(c.col, c.row) = 1;
  s.kinds(c.col, c.row) = kind;
}

// ---- Grown

/// Rivers in an order where each comes after all that join it.
std::vector<std::size_t> tributaries_first(const std::vector<River>& rivers) {
  std::vector<int> depth(rivers.size());
  for (std::size_t i = 0; i < rivers.size(); ++i)
    for (int j = rivers[i].joins; j >= 0; j = rivers[std::size_t(j)].joins) ++depth[i];
  std::vector<std::size_t> order(rivers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](auto a, auto b) { return depth[a] > depth[b]; });
  return order;
}

/// What flows through each cell of a path.
struct Flow {
  Raster<float> level;        ///< the water's elevation; infinite off the paths
  Raster<std::int32_t> mass;  ///< how many sources feed it
};

/// Down the rivers: the masses of confluences add up, and each cell is the lowest so far, less the
/// bed's depth.
Flow flow_down(const Map& map, const Ground& ground, std::vector<River>& rivers,
               const NetworkOptions& o) {
  Flow flow{Raster<float>(map.size, inf), Raster<std::int32_t>(map.size)};
  for (std::size_t i : tributaries_first(rivers)) {
    float lowest = inf;
    int mass = 1;
    for (Cell c : rivers[i].path) {
      float& level = flow.level(c.col, c.row);
      mass += flow.mass(c.col, c.row);  // what has joined here
      const double depth = o.river_depth_m * std::sqrt(double(mass));
      const double bed = ground.altitude_m(map.centre_of(c)) - depth;
      level = lowest = std::min({lowest, level, float(bed)});
      flow.mass(c.col, c.row) = mass;
    }
    rivers[i].mass = mass;
  }
  return flow;
}

/// Gives the cells beside a river its level, as wide as its mass.
void widen(Skeleton& s, const Map& map, const River& river, const Flow& flow, double width_m) {
  const Spacing cell = s.dem.spacing;
  for (Cell c : river.path) {
    const double radius = width_m * std::sqrt(double(flow.mass(c.col, c.row))) / 2;
    const int across = int(radius / cell.dx_m), down = int(radius / cell.dy_m);
    const float level = flow.level(c.col, c.row);
    for (int dr = -down; dr <= down; ++dr)
      for (int dc = -across; dc <= across; ++dc) {
        const Cell bank{c.col + dc, c.row + dr};
        const double x = dc * cell.dx_m, y = dr * cell.dy_m;
        if (x * x + y * y > radius * radius || !map.contains(bank)) continue;
        if (flow.level(bank.col, bank.row) != inf) continue;  // a path, whose level is its own
        const bool wet = s.kinds(bank.col, bank.row) == CellKind::river;
        put(s, bank, CellKind::river,
            double(wet ? std::min(level, s.dem.z(bank.col, bank.row)) : level));
      }
  }
}

// ---- Drawn

enum class Drawn : std::uint8_t { nothing, ridge, river };

Drawn drawn(float grey) {
  if (grey >= 0.98F) return Drawn::nothing;
  return grey >= 0.5F ? Drawn::ridge : Drawn::river;
}

/// The cells of `seeds` and all that spread() reaches from them, breadth first: from each of their
/// neighbours for which enter(from, to) is true, which it is once.
template <class Enter>
void spread(Size size, std::vector<Cell> seeds, Enter enter) {
  std::deque<Cell> queue(seeds.begin(), seeds.end());
  while (!queue.empty()) {
    const Cell from = queue.front();
    queue.pop_front();
    for (const auto [dc, dr] : around) {
      const Cell to{from.col + dc, from.row + dr};
      if (to.col < 0 || to.row < 0 || to.col >= size.cols || to.row >= size.rows) continue;
      if (enter(from, to)) queue.push_back(to);
    }
  }
}

int to_edge(Size size, Cell c) {
  return std::min({c.col, c.row, size.cols - 1 - c.col, size.rows - 1 - c.row});
}

/// One mouth for each river that does not reach the map's edge, and its cells there for those that
/// do.
std::vector<Cell> find_mouths(const Raster<Drawn>& lines) {
  const Size size = lines.size();
  std::vector<Cell> mouths;
  Mask seen(size);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      if (lines(col, row) != Drawn::river || seen(col, row)) continue;
      Cell nearest{col, row};
      bool at_edge = false;
      const auto visit = [&](Cell c) {
        seen(c.col, c.row) = 1;
        if (to_edge(size, c) == 0) mouths.push_back(c), at_edge = true;
        if (to_edge(size, c) < to_edge(size, nearest)) nearest = c;
      };
      visit(nearest);
      spread(size, {{col, row}}, [&](Cell, Cell c) {
        if (lines(c.col, c.row) != Drawn::river || seen(c.col, c.row)) return false;
        visit(c);
        return true;
      });
      if (!at_edge) mouths.push_back(nearest);
    }
  return mouths;
}

double distance_m(Cell a, Cell b, Spacing s) {
  const double x = (a.col - b.col) * s.dx_m, y = (a.row - b.row) * s.dy_m;
  return std::sqrt(x * x + y * y);
}

/// Puts the drawn rivers into the skeleton, from their mouths up; gives the cell below each.
Raster<Cell> put_rivers(Skeleton& s, const Raster<Drawn>& lines, const Raster<float>& drawing,
                        const SketchLinesOptions& o) {
  const bool given = o.heights == LineHeights::given;
  const auto height = [&](Cell c) {
    return given ? std::lerp(o.low_m, o.high_m, double(drawing(c.col, c.row))) : o.low_m;
  };
  Raster<Cell> below(lines.size(), Cell{-1, -1});
  const std::vector<Cell> mouths = find_mouths(lines);
  for (Cell mouth : mouths) {
    below(mouth.col, mouth.row) = mouth;
    put(s, mouth, CellKind::river, height(mouth));
  }
  spread(lines.size(), mouths, [&](Cell from, Cell to) {
    if (lines(to.col, to.row) != Drawn::river || below(to.col, to.row).col >= 0) return false;
    below(to.col, to.row) = from;
    const double foot = double(s.dem.z(from.col, from.row));
    put(s, to, CellKind::river,
        given ? std::max(foot, height(to))
              : foot + o.river_slope * distance_m(from, to, s.dem.spacing));
    return true;
  });
  return below;
}

/// The drawn rivers as paths: from every cell that nothing flows into, down to a cell of another.
std::vector<River> trace_rivers(const Raster<Cell>& below) {
  const Size size = below.size();
  Raster<std::int32_t> owner(size), inflows(size);
  std::vector<Cell> sources;
  const auto is_river = [&](Cell c) { return below(c.col, c.row).col >= 0; };
  const auto each_river_cell = [&](auto visit) {
    for (int row = 0; row < size.rows; ++row)
      for (int col = 0; col < size.cols; ++col)
        if (is_river({col, row})) visit(Cell{col, row});
  };
  each_river_cell([&](Cell c) {
    if (const Cell b = below(c.col, c.row); b != c) ++inflows(b.col, b.row);
  });
  each_river_cell([&](Cell c) {
    if (!inflows(c.col, c.row)) sources.push_back(c);
  });

  std::vector<River> rivers;
  for (Cell source : sources) {
    River river;
    for (Cell c = source;; c = below(c.col, c.row)) {
      river.path.push_back(c);
      if (owner(c.col, c.row)) {
        river.joins = owner(c.col, c.row) - 1;
        break;
      }
      owner(c.col, c.row) = int(rivers.size()) + 1;
      if (below(c.col, c.row) == c) break;
    }
    rivers.push_back(std::move(river));
  }
  for (std::size_t i : tributaries_first(rivers))
    if (rivers[i].joins >= 0) rivers[std::size_t(rivers[i].joins)].mass += rivers[i].mass;
  return rivers;
}

/// Heights above the river cell or edge of the map that is nearest, over steps between neighbours.
Raster<float> heights_above_rivers(const Skeleton& s, const SketchLinesOptions& o) {
  const Size size = s.dem.size();
  Raster<float> height(size, inf);
  Raster<float> distance(size, inf);
  CellQueue queue(0, float(distance_m({0, 0}, {size.cols, size.rows}, s.dem.spacing)), 4096);
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      const bool wet = s.kinds(col, row) == CellKind::river;
      if (!wet && to_edge(size, {col, row}) > 0) continue;
      height(col, row) = wet ? s.dem.z(col, row) : float(o.low_m);
      distance(col, row) = 0;
      queue.push(0, row * size.cols + col);
    }
  while (!queue.empty()) {
    const auto [so_far, index] = queue.pop();
    const Cell from{index % size.cols, index / size.cols};
    if (so_far > distance(from.col, from.row)) continue;  // a shorter way was found since
    for (const auto [dc, dr] : around) {
      const Cell to{from.col + dc, from.row + dr};
      if (to_edge(size, to) < 0) continue;
      const double step = distance_m(from, to, s.dem.spacing);
      const float d = float(double(so_far) + step);
      if (d >= distance(to.col, to.row)) continue;
      distance(to.col, to.row) = d;
      height(to.col, to.row) = height(from.col, from.row) + float(o.ridge_slope * step);
      queue.push(d, to.row * size.cols + to.col);
    }
  }
  return height;
}

/// Puts the drawn ridges into the skeleton, which has its rivers.
void put_ridges(Skeleton& s, const Raster<Drawn>& lines, const Raster<float>& drawing,
                const SketchLinesOptions& o) {
  const bool given = o.heights == LineHeights::given;
  const Raster<float> above = given ? Raster<float>() : heights_above_rivers(s, o);
  for (int row = 0; row < lines.rows(); ++row)
    for (int col = 0; col < lines.cols(); ++col)
      if (lines(col, row) == Drawn::ridge)
        put(s, {col, row}, CellKind::ridge,
            given ? std::lerp(o.low_m, o.high_m, double(drawing(col, row)))
                  : std::min(o.high_m, double(above(col, row))));
}

McmdOptions mcmd_options(const SkeletonFillOptions& o) {
  return {.I = o.I,
          .I_bu = o.I_bu,
          .I_ridge = o.I_ridge,
          .I_bu_ridge = o.I_bu_ridge,
          .I_river = o.I_river,
          .I_bu_river = o.I_bu_river,
          .H = o.H,
          .rt = o.rt,
          .rs = o.rs,
          .seed = o.seed};
}

}  // namespace

std::vector<Field> fields(NetworkOptions& o) {
  return {
      {"ridges", o.ridges, {1, 1000}, "", "couples of ridge particles"},
      {"springs", o.springs, {1, 10000}, "", "river particles, put on the ridges"},
      {"ridge_height_m", o.ridge_height_m, {1, 10000}, "m", "altitude of the highest ridge"},
      {"ridge_variation",
       o.ridge_variation,
       {0, 3},
       "",
       "ridges start lower by up to e^-ridge_variation"},
      {"ridge_length",
       o.ridge_length,
       {0.02, 1},
       "",
       "standard deviation of the altitude along a ridge, as part of the map's longer side"},
      {"ridge_width",
       o.ridge_width,
       {0.05, 1},
       "",
       "standard deviation of the cross-section, as part of ridge_length"},
      {"ridge_wander", o.ridge_wander, {0, 1}, "", "side impacts: 0 makes ridges straight"},
      {"ridge_H", o.ridge_H, {0, 1}, "", "of the ridges' Brownian motion; near 1: smooth"},
      {"dome",
       o.dome,
       {0, 1},
       "",
       "rise of the ground from the map's edges to its middle, as part of ridge_height_m"},
      {"friction",
       o.friction,
       {5, 1000},
       "",
       "a particle without slope loses its speed over 1 / friction of the map's longer side"},
      {"river_depth_m",
       o.river_depth_m,
       {0, 1000},
       "m",
       "how deep a river of one source is cut; grows with the root of the number of sources"},
      {"river_width_m", o.river_width_m, {0, 10000}, "m", "the same for its width"},
      {"seed", o.seed, "of ridges and rivers"},
  };
}

std::vector<Field> fields(SketchLinesOptions& o) {
  return {
      {"heights", o.heights, {"generated", "given"}, "heights on the lines: made, or their greys"},
      {"low_m", o.low_m, {-20000, 20000}, "m", "height of black; of mouths, when generated"},
      {"high_m", o.high_m, {-20000, 20000}, "m", "height of white; the highest, when generated"},
      {"river_slope", o.river_slope, {0, 10}, "m/m", "rise of generated rivers from their mouths"},
      {"ridge_slope",
       o.ridge_slope,
       {0, 10},
       "m/m",
       "rise of generated ridges from the nearest river or edge"},
  };
}

std::vector<Field> fields(SkeletonFillOptions& o) {
  const Range bends{-100, 100};
  return {
      {"fill", o.fill, {"mcmd", "mdi"}, "what fills between the lines"},
      {"I_bu", o.I_bu, bends, "", "mcmd: bottom-up, elevations fall (> 0) with distance"},
      {"I", o.I, bends, "", "mcmd: the same, top-down"},
      {"I_bu_ridge", o.I_bu_ridge, bends, "", "mcmd: I_bu of ridge cells"},
      {"I_ridge", o.I_ridge, bends, "", "mcmd: I of ridge cells"},
      {"I_bu_river", o.I_bu_river, bends, "", "mcmd: I_bu of river cells"},
      {"I_river", o.I_river, bends, "", "mcmd: I of river cells"},
      {"H", o.H, {-0.5, 1}, "", "noise falls as 2^-(1 + 2 H) from one level to the next finer"},
      {"rt", o.rt, {-10, 10}, "", "shift of the random numbers [-1, 1]"},
      {"rs", o.rs, {0, 1e6}, "m/cell", "noise at the coarsest level, per cell of distance"},
      {"rs_bu", o.rs_bu, {0, 1e6}, "m/cell", "mdi: noise of the bottom-up means"},
      {"seed", o.seed, "of the noise"},
  };
}

Skeleton grow_skeleton(Size size, Spacing spacing, const NetworkOptions& o, const Run& run) {
  check_options(o);
  check_map(size, spacing, 16, "ridges and rivers");
  const Map map(size, spacing);
  const std::vector<RidgeCell> ridges = grow_ridges(map, o, run.part(0, 0.2));
  const Ground ground(map, ridges, o);
  Skeleton s = empty_skeleton(size, spacing);
  s.rivers = grow_rivers(map, ground, ridges, o, run.part(0.2, 0.9));
  if (s.rivers.empty())
    throw std::invalid_argument(
        fmt::format("springs = {}: no river leaves the map; must be more, or with another seed "
                    "or number of ridges",
                    o.springs));

  for (const auto& ridge : ridges)
    put(s, ridge.cell, CellKind::ridge, ground.altitude_m(map.centre_of(ridge.cell), ridge.fall));
  const Flow flow = flow_down(map, ground, s.rivers, o);
  for (const River& river : s.rivers) widen(s, map, river, flow, o.river_width_m);
  for (const River& river : s.rivers)
    for (Cell c : river.path) put(s, c, CellKind::river, double(flow.level(c.col, c.row)));
  run.report(1, "skeleton");
  return s;
}

Skeleton read_skeleton(const Raster<float>& drawing, Spacing spacing, const SketchLinesOptions& o,
                       const Run& run) {
  check_options(o);
  check_map(drawing.size(), spacing, 2, "a drawing of ridges and rivers");
  Raster<Drawn> lines(drawing.size());
  std::array<std::size_t, 3> count{};
  for (std::size_t i = 0; i < lines.cells().size(); ++i) {
    lines.cells()[i] = drawn(drawing.cells()[i]);
    ++count[std::size_t(lines.cells()[i])];
  }
  if (count[0] == lines.cells().size())
    throw std::invalid_argument(
        "the drawing is all white; must have ridges (lighter greys) or rivers (darker greys)");
  if (count[0] == 0)
    throw std::invalid_argument("the drawing has no white; must leave room between its lines");

  Skeleton s = empty_skeleton(drawing.size(), spacing);
  const Raster<Cell> below = put_rivers(s, lines, drawing, o);
  run.report(0.4, "rivers");
  s.rivers = trace_rivers(below);
  put_ridges(s, lines, drawing, o);
  run.report(1, "ridges");
  return s;
}

Raster<float> fill_skeleton(const Skeleton& s, const SkeletonFillOptions& o, const Run& run) {
  check_options(o);
  if (o.fill == SkeletonFill::mdi)
    return fill_mdi(s.dem, {.rs_bu = o.rs_bu, .H = o.H, .rt = o.rt, .rs = o.rs, .seed = o.seed},
                    run);
  return fill_mcmd(s.dem, mcmd_options(o), run, s.kinds);
}

std::vector<Field> fields(RidgesOptions& o) {
  std::vector<Field> list = fields(o.network);
  for (auto& field : fields(o.fill))
    if (field.name() != "seed") list.push_back(std::move(field));
  return list;
}

Raster<float> generate_ridges(const Canvas& canvas, const RidgesOptions& o, const Run& run) {
  SkeletonFillOptions fill = o.fill;
  fill.seed = o.network.seed;
  return fill_skeleton(grow_skeleton(canvas.size, canvas.spacing, o.network, run.part(0, 0.5)),
                       fill, run.part(0.5, 1));
}

std::vector<Field> fields(DrawnSkeletonOptions& o) {
  std::vector<Field> list = fields(o.lines);
  for (auto& field : fields(o.fill)) list.push_back(std::move(field));
  return list;
}

Raster<float> generate_skeleton(const Canvas& canvas, const Raster<float>& drawing,
                                const DrawnSkeletonOptions& o, const Run& run) {
  return fill_skeleton(read_skeleton(drawing, canvas.spacing, o.lines, run.part(0, 0.5)), o.fill,
                       run.part(0.5, 1));
}

}  // namespace dem
