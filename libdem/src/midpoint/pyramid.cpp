// The midpoint lattice as a pyramid: the bottom-up pass by levels, and the top-down pass.
//
// Level k holds the nodes whose stride is at least 2^k as a small raster of its own, so that every
// level is the same problem, on a quarter of the cells. In a level, with even-numbered rows and
// columns (and the last ones, whatever their number) older than the odd ones:
//
//     A---e---A     A: older node, also a node of the next level
//     | \ | / |     e: edge,   one of its coordinates is odd
//     e---c---e     c: centre, both are odd
//     | / | \ |
//     A---e---A     Where a level's last number is odd, the gap before it is empty and shorter.
//
// A node's children in one level are its eight neighbours, as far as they are younger, so both
// passes read rows three at a time and add neighbours with weights: straight loops that vectorise.
// Level 0 is the DEM itself. It is never copied: what the bottom-up pass computes there (centres
// from their four edges) is computed again on the way down.

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "midpoint/lattice.h"
#include "midpoint/midpoint.h"
#include "midpoint/row_kernels.h"
#include "numeric/parallel.h"
#include "numeric/random.h"

namespace dem::midpoint {
using namespace numeric;

double bend_factor(double exponent, double part) {
  if (exponent == 0) return 1;
  const double fall = 1 - std::pow(1 - part, std::abs(exponent));
  return exponent > 0 ? 1 - fall : 1 + fall;
}

double Midpoint::diagonal() const { return std::hypot(double(dem.z.cols()), double(dem.z.rows())); }

namespace {

constexpr std::uint64_t stream_down = 1;

// ---- Levels

/// One axis of one level: n nodes, `stride` cells apart, the last one `gap` after the one before.
struct LevelAxis {
  int n = 1;
  int stride = 1;
  int gap = 1;

  static LevelAxis finest(int cells) { return {cells, 1, 1}; }
  LevelAxis coarser() const {
    if (n <= 2) return *this;
    const int half = (n - 1) / 2;  // nodes 0, 2, .. 2 * half, and the last when it is odd
    return (n - 1) % 2 == 0 ? LevelAxis{half + 1, 2 * stride, half == 0 ? gap : stride + gap}
                            : LevelAxis{half + 2, 2 * stride, gap};
  }

  int last() const { return n - 1; }
  int cell(int i) const { return i == last() && n > 1 ? (n - 2) * stride + gap : i * stride; }
  bool young(int i) const { return i % 2 == 1 && i < last(); }  // born at this level
  int next(int older) const { return older == last() ? coarser().last() : older / 2; }
  int from_next(int i, int next_last) const { return i == next_last ? last() : 2 * i; }

  // The distance to the neighbour below or above when it exists and one of the two is young, else
  // 0.
  int below(int i) const {
    if (i < 1 || !(young(i) || young(i - 1))) return 0;
    return i == last() ? gap : stride;
  }
  int above(int i) const {
    if (i >= last() || !(young(i) || young(i + 1))) return 0;
    return i + 1 == last() ? gap : stride;
  }
};

/// The nodes of one level. A node is known (weight < 0, z its height), or it has been reached by
/// children (weight > 0, z their weighted sum), or neither (weight = 0, z = 0).
struct Level {
  LevelAxis x, y;
  Raster<float> z, weight;                           // empty at level 0, which is the DEM
  Raster<CellKind> kinds{};                          // empty at level 0, and when all are plain
  std::vector<std::vector<std::int32_t>> special{};  // of each row, the nodes that are not plain
};

/// Of each row, the nodes that are not plain.
std::vector<std::vector<std::int32_t>> special_nodes(const Raster<CellKind>& kinds) {
  std::vector<std::vector<std::int32_t>> rows(std::size_t(kinds.rows()));
  for (int y = 0; y < kinds.rows(); ++y) {
    const auto row = kinds.row(y);
    for (auto at = row.begin();; ++at) {
      at = std::find_if(at, row.end(), [](CellKind kind) { return kind != CellKind::plain; });
      if (at == row.end()) break;
      rows[std::size_t(y)].push_back(std::int32_t(at - row.begin()));
    }
  }
  return rows;
}

/// The kinds of the next level's nodes, and which are special.
void coarsen_kinds(const Level& level, const Raster<CellKind>& kinds, Level& next) {
  next.kinds = Raster<CellKind>({next.x.n, next.y.n});
  next.special.resize(std::size_t(next.y.n));
  for (int next_y = 0; next_y < next.y.n; ++next_y) {
    const int y = level.y.from_next(next_y, next.y.last());
    for (std::int32_t x : level.special[std::size_t(y)]) {
      if (level.x.young(x)) continue;
      next.kinds(level.x.next(x), next_y) = kinds(x, y);
      next.special[std::size_t(next_y)].push_back(level.x.next(x));
    }
  }
}

// ---- Weights and kernels

/// Distances in cells to a node's neighbours on its four sides; 0: there is none.
struct Sides {
  int l = 0, r = 0, u = 0, d = 0;
  bool operator==(const Sides&) const = default;
};

/// What a node takes from its neighbours.
struct Rule {
  Sides sides;
  Cross plain;                // weights of the neighbours
  std::array<Cross, 3> bent;  // the same times Delta(e, d) / e, for each CellKind
  double side_distance = 0, corner_distance = 0;  // means over the neighbours there are
};

/// The rules of one pass, made when first asked for: a raster has a handful.
class Rules {
 public:
  /// Bottom-up: neighbours weigh distance^-weight_exponent.
  Rules(const Pull& pull, double diagonal)
      : bend_(pull.bend), exponent_(pull.weight_exponent), diagonal_(diagonal) {}
  /// Top-down: plain means over the sides, and over the corners.
  Rules(const Bend& bend, double diagonal) : bend_(bend), mean_(true), diagonal_(diagonal) {}

  bool bends_as_plain(CellKind kind) const { return bend_[std::size_t(kind)] == bend_[0]; }
  bool bends_alike() const { return bend_[1] == bend_[0] && bend_[2] == bend_[0]; }

  const Rule& of(Sides sides) {
    for (const Rule& rule : rules_)
      if (rule.sides == sides) return rule;
    return rules_.emplace_back(make(sides));
  }

 private:
  Rule make(Sides s) const {
    const auto diagonal = [](int a, int b) { return a && b ? std::hypot(a, b) : 0.0; };
    const double side[] = {double(s.l), double(s.r), double(s.u), double(s.d)};
    const double corner[] = {diagonal(s.l, s.u), diagonal(s.r, s.u), diagonal(s.l, s.d),
                             diagonal(s.r, s.d)};
    const auto count = [](const double* d) { return 4.0 - double(std::count(d, d + 4, 0.0)); };
    const auto weight = [&](double d, double n) {
      return d == 0 ? 0.0 : mean_ ? 1 / n : std::pow(d, -exponent_);
    };
    std::array<double, 4> side_weight, corner_weight;
    for (std::size_t i = 0; i < 4; ++i) {
      side_weight[i] = weight(side[i], count(side));
      corner_weight[i] = weight(corner[i], count(corner));
    }
    const auto cross = [&](auto factor) {
      const auto w = [&](const double* d, const auto& weights, std::size_t i) {
        return float(weights[i] * factor(d[i]));
      };
      return Cross{w(side, side_weight, 0),     w(side, side_weight, 1),
                   w(side, side_weight, 2),     w(side, side_weight, 3),
                   w(corner, corner_weight, 0), w(corner, corner_weight, 1),
                   w(corner, corner_weight, 2), w(corner, corner_weight, 3)};
    };
    const auto mean = [&](const double* d) {
      return (d[0] + d[1] + d[2] + d[3]) / std::max(count(d), 1.0);
    };
    Rule rule{s, cross([](double) { return 1.0; }), {}, mean(side), mean(corner)};
    for (std::size_t kind = 0; kind < 3; ++kind)
      rule.bent[kind] = cross([&](double d) { return bend_factor(bend_[kind], d / diagonal_); });
    return rule;
  }

  Bend bend_;
  double exponent_ = 0;
  bool mean_ = false;
  double diagonal_;
  std::vector<Rule> rules_;
};

/// The sums of row_kernels.h for one node anywhere.
template <bool Add>
void sum_one(const Rows& z, const Cross& w, Take take, int n, int x, float* out) {
  const auto at = [&](const float* row, int i) { return i >= 0 && i < n ? row[i] : 0; };
  const float side =
      (w.l * at(z.here, x - 1) + w.r * at(z.here, x + 1)) + (w.u * z.up[x] + w.d * z.down[x]);
  const float corner = (w.ul * at(z.up, x - 1) + w.ur * at(z.up, x + 1)) +
                       (w.dl * at(z.down, x - 1) + w.dr * at(z.down, x + 1));
  const float value = take == Take::sides ? side : take == Take::corners ? corner : side + corner;
  out[x] = Add ? out[x] + value : value;
}

// ---- One fill

constexpr int no_row = -1;

class Pyramid {
 public:
  explicit Pyramid(const Midpoint& fill);

  /// Bottom-up with means.
  void carry_up(const Pull& pull, const Run& run);
  /// Bottom-up without: only known cells are known, as in plain MD.
  void sample();

  Raster<float> displace(const Bend& bend, const Noise& noise, std::optional<double> root_m,
                         const Run& run);

  /// After carry_up: the DEM with the ascendants that became known.
  Dem known_cells() const;

 private:
  /// Heights and knowledge (1 or 0) of one row of a level.
  struct Slot {
    int y = no_row;
    std::vector<float> height, known;
  };

  /// The working space of one thread on one level: four rows that slide over it, and sums.
  struct Desk {
    const Level& level;
    Rules up, down;
    std::array<Slot, 4> slots;
    std::vector<std::int32_t> young;  // all ones in the young columns, else 0
    std::vector<float> sum, weight;
    std::vector<int> summed;  // by kinds: in which sum_heights()
    int sums = 0;
  };

  bool diamond() const { return fill_.subdivision == Subdivision::diamond_square; }
  const Raster<CellKind>& kinds_of(const Level& level) const {
    return finest(level) ? fill_.kinds : level.kinds;
  }
  bool finest(const Level& level) const { return &level == levels_.data(); }
  static const Level& coarser(const Level& level) { return *(&level + 1); }
  Desk desk(const Level& level) const;
  template <class Work>
  void in_row_blocks(const Level& level, int rows, const char* what, const Run& run,
                     Work work) const;

  Slot& loaded(Desk& desk, int y) const;
  Slot& with_centres(Desk& desk, int y) const;
  Slot& with_ascendants(Desk& desk, int y) const;

  Sides sides_at(const Level& level, int x, int y, bool ends_only) const;
  Sides inner_sides(const Level& level, int y, bool ends_only) const;
  void sum_heights(Desk& desk, Rules& rules, int y, const Rows& z, Take take, bool ends_only) const;
  void sum_kinds(Desk& desk, Rules& rules, int y, const Rows& z, Take take, bool ends_only) const;
  float sum_by_kinds(const Level& level, const Rule& rule, int x, int y, const float* const rows[3],
                     Take take) const;
  void sum_weights(Desk& desk, int y, const Rows& known, Take take) const;

  void finish_young(Level& level, const Run& run);
  void coarsen(const Level& level, Level& next, const Run& run);
  void coarsen_row(Desk& desk, Level& next, int next_y) const;

  float mean_of_known_roots() const;
  double noise_scale(const Level& level) const;
  float displacement(const Level& level, int x, int y, double scale, double distance) const;
  void sum_ascendants(Desk& desk, int y, const Rows& z, bool centres) const;
  void refine(Level& level, const Run& run);
  void refine_row(Desk& desk, Level& level, int y, bool centres) const;
  void store_row(Desk& desk, int y, Raster<float>& out) const;

  const Midpoint& fill_;
  std::vector<Level> levels_;
  std::vector<float> zeros_;
  Pull pull_;
  Bend bend_{};
  Noise noise_;
  bool carried_up_ = false;
};

Pyramid::Pyramid(const Midpoint& fill) : fill_(fill), zeros_(std::size_t(fill.dem.z.cols()), 0.f) {
  Level level{LevelAxis::finest(fill.dem.z.cols()), LevelAxis::finest(fill.dem.z.rows()), {}, {}};
  levels_.push_back(level);
  while (level.x.n > 2 || level.y.n > 2) {
    level = {level.x.coarser(), level.y.coarser(), {}, {}};
    levels_.push_back(level);
  }
  if (!fill.kinds.empty()) {
    levels_[0].special = special_nodes(fill.kinds);
    for (std::size_t k = 1; k < levels_.size(); ++k)
      coarsen_kinds(levels_[k - 1], kinds_of(levels_[k - 1]), levels_[k]);
  }
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const Size size{levels_[k].x.n, levels_[k].y.n};
    levels_[k].z = Raster<float>::unset(size);
    levels_[k].weight = Raster<float>::unset(size);
  }
}

Pyramid::Desk Pyramid::desk(const Level& level) const {
  const std::vector<float> row(std::size_t(level.x.n), 0.f);
  const Slot slot{no_row, row, row};
  std::vector<std::int32_t> young(row.size());
  for (int x = 1; x < level.x.last(); x += 2) young[std::size_t(x)] = -1;
  const std::vector<int> summed(fill_.kinds.empty() ? 0 : row.size(), 0);
  return {level,
          Rules(pull_, fill_.diagonal()),
          Rules(bend_, fill_.diagonal()),
          {slot, slot, slot, slot},
          std::move(young),
          row,
          row,
          summed};
}

/// Runs work(desk, first, last) over blocks of rows, in parallel, each with a desk of its own.
template <class Work>
void Pyramid::in_row_blocks(const Level& level, int rows, const char* what, const Run& run,
                            Work work) const {
  constexpr int block = 64, blocks_between_reports = 32;
  const int blocks = (rows + block - 1) / block;
  for (int begin = 0; begin < blocks; begin += blocks_between_reports) {
    run.report(double(begin) / double(blocks), what);
    parallel_for(begin, std::min(blocks, begin + blocks_between_reports), 1, [&](int b) {
      Desk own = desk(level);
      work(own, b * block, std::min(rows, (b + 1) * block));
    });
  }
}

// ---- Rows

/// Row y of the desk's level: heights where known, else 0.
Pyramid::Slot& Pyramid::loaded(Desk& desk, int y) const {
  Slot& slot = desk.slots[std::size_t(y % 4)];
  if (slot.y == y) return slot;
  slot.y = y;
  const Level& level = desk.level;
  if (finest(level))
    load_known(fill_.dem.z.row(y).data(), fill_.dem.known.row(y).data(), fill_.reference_m,
               level.x.n, slot.height.data(), slot.known.data());
  else
    load_settled(level.z.row(y).data(), level.weight.row(y).data(), level.x.n, slot.height.data(),
                 slot.known.data());
  return slot;
}

/// Row y, and if it is a young row of level 0, its centres carried up from their four edges.
/// (Coarser levels have theirs stored by finish_young.)
Pyramid::Slot& Pyramid::with_centres(Desk& desk, int y) const {
  if (!carried_up_ || !diamond() || !finest(desk.level) || !desk.level.y.young(y))
    return loaded(desk, y);
  Slot& slot = desk.slots[std::size_t(y % 4)];
  if (slot.y == y) return slot;
  const Slot& up = loaded(desk, y - 1);
  const Slot& down = loaded(desk, y + 1);
  loaded(desk, y);
  sum_heights(desk, desk.up, y, {up.height.data(), slot.height.data(), down.height.data()},
              Take::sides, false);
  sum_weights(desk, y, {up.known.data(), slot.known.data(), down.known.data()}, Take::sides);

  complete_reached(desk.young.data(), desk.sum.data(), desk.weight.data(), desk.level.x.n,
                   slot.height.data(), slot.known.data());
  return slot;
}

// ---- Sums over neighbours

/// The neighbours of node (x, y). `ends_only`: of an edge, only its two ends.
Sides Pyramid::sides_at(const Level& level, int x, int y, bool ends_only) const {
  Sides s{level.x.below(x), level.x.above(x), level.y.below(y), level.y.above(y)};
  if (ends_only && !level.x.young(x)) s.l = s.r = 0;
  if (ends_only && !level.y.young(y)) s.u = s.d = 0;
  return s;
}

/// The same for the columns 1 .. n - 3, which are all alike.
Sides Pyramid::inner_sides(const Level& level, int y, bool ends_only) const {
  Sides s{level.x.stride, level.x.stride, level.y.below(y), level.y.above(y)};
  if (ends_only && level.y.young(y)) s.l = s.r = 0;
  if (ends_only && !level.y.young(y)) s.u = s.d = 0;
  return s;
}

/// Calls each(x) for the columns that are not like the inner ones.
template <class Each>
void for_outer_columns(int n, Each each) {
  each(0);
  for (int x = std::max(1, n - 2); x < n; ++x) each(x);
}

/// desk.sum = the neighbours' heights in row y, weighted and bent.
void Pyramid::sum_heights(Desk& desk, Rules& rules, int y, const Rows& z, Take take,
                          bool ends_only) const {
  const Level& level = desk.level;
  const int n = level.x.n;
  float* sum = desk.sum.data();
  if (n > 3) sum_neighbours(z, rules.of(inner_sides(level, y, ends_only)).bent[0], take, n, sum);
  for_outer_columns(n, [&](int x) {
    sum_one<false>(z, rules.of(sides_at(level, x, y, ends_only)).bent[0], take, n, x, sum);
  });
  if (!level.special.empty()) sum_kinds(desk, rules, y, z, take, ends_only);
}

/// Of desk.sum, the columns beside nodes whose kind bends otherwise than the plain.
void Pyramid::sum_kinds(Desk& desk, Rules& rules, int y, const Rows& z, Take take,
                        bool ends_only) const {
  if (rules.bends_alike()) return;
  const Level& level = desk.level;
  const int n = level.x.n;
  const float* rows[] = {z.up, z.here, z.down};
  ++desk.sums;
  for (int at = 0; at < 3; ++at) {
    if (rows[at] == zeros_.data()) continue;
    const auto kinds = kinds_of(level).row(y - 1 + at);
    for (std::int32_t special : level.special[std::size_t(y - 1 + at)]) {
      if (rules.bends_as_plain(kinds[std::size_t(special)])) continue;
      for (int x = std::max(0, special - 1); x <= std::min(n - 1, special + 1); ++x) {
        if (std::exchange(desk.summed[std::size_t(x)], desk.sums) == desk.sums) continue;
        const bool inner = n > 3 && x >= 1 && x < n - 2;
        const Rule& rule =
            rules.of(inner ? inner_sides(level, y, ends_only) : sides_at(level, x, y, ends_only));
        desk.sum[std::size_t(x)] = sum_by_kinds(level, rule, x, y, rows, take);
      }
    }
  }
}

/// The neighbours of one node, each with the bend of its kind.
float Pyramid::sum_by_kinds(const Level& level, const Rule& rule, int x, int y,
                            const float* const rows[3], Take take) const {
  float near[3][3][3] = {};  // kind, row, column
  for (int r = 0; r < 3; ++r) {
    if (rows[r] == zeros_.data()) continue;
    const CellKind* kinds = kinds_of(level).row(y - 1 + r).data() + (x - 1);
    const float* z = rows[r] + (x - 1);
    for (int c = x > 0 ? 0 : 1; c < (x < level.x.last() ? 3 : 2); ++c)
      near[std::size_t(kinds[c])][r][c] = z[c];
  }
  float sum[3] = {0, 0, 0};
  for (std::size_t kind = 0; kind < 3; ++kind)
    sum_one<true>({near[kind][0], near[kind][1], near[kind][2]}, rule.bent[kind], take, 3, 1, sum);
  return sum[1];
}

/// desk.weight = the weights of the known neighbours in row y.
void Pyramid::sum_weights(Desk& desk, int y, const Rows& known, Take take) const {
  const Level& level = desk.level;
  const int n = level.x.n;
  float* weight = desk.weight.data();
  if (n > 3) sum_neighbours(known, desk.up.of(inner_sides(level, y, false)).plain, take, n, weight);
  for_outer_columns(n, [&](int x) {
    sum_one<false>(known, desk.up.of(sides_at(level, x, y, false)).plain, take, n, x, weight);
  });
}

// ---- Bottom-up

void Pyramid::carry_up(const Pull& pull, const Run& whole) {
  pull_ = pull;
  carried_up_ = true;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const Run run = k == 0 ? whole : whole.part(1, 1);
    if (k > 0) finish_young(levels_[k], run);
    if (k + 1 < levels_.size()) coarsen(levels_[k], levels_[k + 1], run);
  }
  Level& roots = levels_.back();
  const std::array<std::int32_t, 2> all{-1, -1};
  for (int y = 0; y < roots.z.rows(); ++y)
    settle_row(all.data(), 0, zeros_.data(), zeros_.data(), roots.x.n, roots.z.row(y).data(),
               roots.weight.row(y).data());
}

void Pyramid::sample() {
  for (std::size_t k = 0; k + 1 < levels_.size(); ++k)
    coarsen(levels_[k], levels_[k + 1], fill_.run.part(0, 0));
}

/// The young nodes of a coarser level: edges from what their children gave, then centres from that
/// and, in diamond-square, from their own four edges.
void Pyramid::finish_young(Level& level, const Run& run) {
  const auto settle = [&](Desk& desk, int y, std::int32_t other, const float* sum,
                          const float* weight) {
    settle_row(desk.young.data(), other, sum, weight, level.x.n, level.z.row(y).data(),
               level.weight.row(y).data());
  };
  in_row_blocks(level, level.y.n, "bottom-up", run, [&](Desk& desk, int begin, int end) {
    for (int y = begin; y < end; ++y)
      settle(desk, y, level.y.young(y) ? -1 : 0, zeros_.data(), zeros_.data());
  });
  in_row_blocks(level, level.y.n, "bottom-up", run, [&](Desk& desk, int begin, int end) {
    for (int y = begin | 1; y < end && level.y.young(y); y += 2) {
      if (diamond()) {
        const Slot &up = loaded(desk, y - 1), &here = loaded(desk, y), &down = loaded(desk, y + 1);
        sum_heights(desk, desk.up, y, {up.height.data(), here.height.data(), down.height.data()},
                    Take::sides, false);
        sum_weights(desk, y, {up.known.data(), here.known.data(), down.known.data()}, Take::sides);
      }
      settle(desk, y, 0, desk.sum.data(), desk.weight.data());
    }
  });
}

/// The old nodes of a level with what their young neighbours give, as the next level.
void Pyramid::coarsen(const Level& level, Level& next, const Run& run) {
  in_row_blocks(level, next.y.n, "bottom-up", run, [&](Desk& desk, int begin, int end) {
    for (int y = begin; y < end; ++y) coarsen_row(desk, next, y);
  });
}

void Pyramid::coarsen_row(Desk& desk, Level& next, int next_y) const {
  const Level& level = desk.level;
  const int y = level.y.from_next(next_y, next.y.last());
  const Slot* here = &loaded(desk, y);
  if (carried_up_) {
    const bool has_up = level.y.below(y) > 0, has_down = level.y.above(y) > 0;
    const Slot* up = has_up ? &with_centres(desk, y - 1) : nullptr;
    const Slot* down = has_down ? &with_centres(desk, y + 1) : nullptr;
    loaded(desk, y);
    const auto row = [&](const Slot* slot, const std::vector<float> Slot::*what) {
      return slot ? (slot->*what).data() : zeros_.data();
    };
    sum_heights(desk, desk.up, y,
                {row(up, &Slot::height), here->height.data(), row(down, &Slot::height)}, Take::both,
                false);
    sum_weights(desk, y, {row(up, &Slot::known), here->known.data(), row(down, &Slot::known)},
                Take::both);
  } else {
    std::ranges::fill(desk.sum, 0.f);
    std::ranges::fill(desk.weight, 0.f);
  }
  float* z = next.z.row(next_y).data();
  float* weight = next.weight.row(next_y).data();
  const float* own_z = finest(level) ? zeros_.data() : level.z.row(y).data();
  const float* own_weight = finest(level) ? zeros_.data() : level.weight.row(y).data();
  add_own(here->height.data(), here->known.data(), own_z, own_weight, level.x.n, desk.sum.data(),
          desk.weight.data());
  for (int next_x = 0; next_x < next.x.last(); ++next_x) {
    z[next_x] = desk.sum[std::size_t(2 * next_x)];
    weight[next_x] = desk.weight[std::size_t(2 * next_x)];
  }
  z[next.x.last()] = desk.sum.back();
  weight[next.x.last()] = desk.weight.back();
}

// ---- Top-down

Raster<float> Pyramid::displace(const Bend& bend, const Noise& noise, std::optional<double> root_m,
                                const Run& run) {
  bend_ = bend;
  noise_ = noise;
  const float root = root_m ? float(*root_m) - fill_.reference_m : mean_of_known_roots();
  auto out = Raster<float>::unset(fill_.dem.size());
  if (levels_.size() == 1) {  // at most 2 x 2 cells: all roots
    for (std::size_t i = 0; i < out.cells().size(); ++i)
      out.cells()[i] =
          fill_.dem.known.cells()[i] ? fill_.dem.z.cells()[i] : root + fill_.reference_m;
    return out;
  }
  Level& roots = levels_.back();
  for (std::size_t i = 0; i < roots.z.cells().size(); ++i)
    if (roots.weight.cells()[i] >= 0) roots.z.cells()[i] = root;
  for (std::size_t k = levels_.size() - 2; k > 0; --k) refine(levels_[k], run.part(0, 0));

  in_row_blocks(levels_.front(), out.rows(), "top-down", run, [&](Desk& desk, int begin, int end) {
    for (int y = begin; y < end; ++y) store_row(desk, y, out);
  });
  return out;
}

/// The mean of the roots that are known, relative to the reference; 0 when none is.
float Pyramid::mean_of_known_roots() const {
  double sum = 0;
  int n = 0;
  for (int row : {0, fill_.dem.z.rows() - 1})
    for (int col : {0, fill_.dem.z.cols() - 1}) {
      const Level& roots = levels_.back();
      if (levels_.size() == 1) {
        if (!fill_.dem.known(col, row)) continue;
        sum += double(fill_.dem.z(col, row) - fill_.reference_m);
      } else {
        const int x = std::min(col, roots.x.last()), y = std::min(row, roots.y.last());
        if (roots.weight(x, y) >= 0) continue;
        sum += double(roots.z(x, y));
      }
      ++n;
    }
  return n ? float(sum / n) : 0;
}

/// Equation 1 at the nodes of a level, without its random numbers.
double Pyramid::noise_scale(const Level& level) const {
  const int coarsest = int(levels_.size()) - 2, r = coarsest - int(&level - levels_.data());
  return noise_.rs * std::exp2(-2 * noise_.H * r);
}

/// Equation 1 for node (x, y) of a level, times the mean distance of its ascendants.
float Pyramid::displacement(const Level& level, int x, int y, double scale, double distance) const {
  const double su_rand =
      signed_uniform(random_bits(noise_.seed, stream_down, level.x.cell(x), level.y.cell(y)));
  return float((su_rand + noise_.rt) * scale * distance);
}

/// desk.sum = what the ascendants of the edges or centres in row y give them.
void Pyramid::sum_ascendants(Desk& desk, int y, const Rows& z, bool centres) const {
  const bool ends_only = !centres && !diamond();
  sum_heights(desk, desk.down, y, z, centres ? Take::corners : Take::sides, ends_only);
  if (noise_.rs == 0) return;
  const Level& level = desk.level;
  const double scale = noise_scale(level);
  const auto distance = [&](Sides sides) {
    const Rule& rule = desk.down.of(sides);
    return centres ? rule.corner_distance : rule.side_distance;
  };
  const int n = level.x.n;
  const bool young = centres || !level.y.young(y);  // which columns are computed
  const double inner = n > 3 ? distance(inner_sides(level, y, ends_only)) : 0;
  for (int x = young ? 1 : 2; x < n - 2; x += 2)
    desk.sum[std::size_t(x)] += displacement(level, x, y, scale, inner);
  for_outer_columns(n, [&](int x) {
    if (level.x.young(x) == young)
      desk.sum[std::size_t(x)] +=
          displacement(level, x, y, scale, distance(sides_at(level, x, y, ends_only)));
  });
}

/// Completes a coarser level from the next one: old nodes, centres, edges of old and of young rows,
/// each step reading only what the steps before it wrote.
void Pyramid::refine(Level& level, const Run& run) {
  const Level& next = coarser(level);
  in_row_blocks(level, next.y.n, "top-down", run, [&](Desk&, int begin, int end) {
    for (int next_y = begin; next_y < end; ++next_y) {
      const int y = level.y.from_next(next_y, next.y.last());
      for (int next_x = 0; next_x < next.x.n; ++next_x)
        level.z(level.x.from_next(next_x, next.x.last()), y) = next.z(next_x, next_y);
    }
  });
  const auto step = [&](bool young_rows, bool centres) {
    in_row_blocks(level, level.y.n, "top-down", run, [&](Desk& desk, int begin, int end) {
      for (int y = begin; y < end; ++y)
        if (level.y.young(y) == young_rows) refine_row(desk, level, y, centres);
    });
  };
  step(true, true);
  step(false, false);
  step(true, false);
}

void Pyramid::refine_row(Desk& desk, Level& level, int y, bool centres) const {
  const auto row = [&](int at, int distance) {
    return distance > 0 ? level.z.row(at).data() : zeros_.data();
  };
  sum_ascendants(desk, y, {row(y - 1, level.y.below(y)), row(y, 1), row(y + 1, level.y.above(y))},
                 centres);
  float* z = level.z.row(y).data();
  const float* weight = level.weight.row(y).data();
  const std::int32_t other = centres || !level.y.young(y) ? 0 : -1;  // young columns, or the old
  for (int x = 0; x < level.x.n; ++x) {
    const std::size_t i = std::size_t(x);
    const std::int32_t take = (desk.young[i] ^ other) & -std::int32_t(weight[x] >= 0);
    z[x] = choose(take, desk.sum[i], z[x]);
  }
}

/// Row y of level 0 with its old nodes or its centres complete: all that its edges need.
Pyramid::Slot& Pyramid::with_ascendants(Desk& desk, int y) const {
  const Level& level = desk.level;
  Slot& slot = desk.slots[std::size_t(y % 4)];
  if (slot.y == y) return slot;
  if (!level.y.young(y)) {
    loaded(desk, y);
    const Level& next = coarser(level);
    const float* z = next.z.row(level.y.next(y)).data();
    for (int next_x = 0; next_x < next.x.last(); ++next_x)
      slot.height[std::size_t(2 * next_x)] = z[next_x];
    slot.height.back() = z[next.x.last()];
    return slot;
  }
  const Slot& up = with_ascendants(desk, y - 1);
  const Slot& down = with_ascendants(desk, y + 1);
  with_centres(desk, y);
  sum_ascendants(desk, y, {up.height.data(), slot.height.data(), down.height.data()}, true);
  complete_unknown(desk.young.data(), desk.sum.data(), slot.known.data(), level.x.n,
                   slot.height.data());
  return slot;
}

/// Row y of the result: known cells as given, older nodes as they are, edges computed.
void Pyramid::store_row(Desk& desk, int y, Raster<float>& out) const {
  const Level& level = desk.level;
  const bool has_up = level.y.below(y) > 0, has_down = level.y.above(y) > 0;
  const float* up = has_up ? with_ascendants(desk, y - 1).height.data() : zeros_.data();
  const float* down = has_down ? with_ascendants(desk, y + 1).height.data() : zeros_.data();
  const float* here = with_ascendants(desk, y).height.data();
  sum_ascendants(desk, y, {up, here, down}, false);

  const std::int32_t other = level.y.young(y) ? -1 : 0;  // edges: young columns, or the old ones
  store_known(fill_.dem.z.row(y).data(), fill_.dem.known.row(y).data(), fill_.reference_m,
              desk.young.data(), other, desk.sum.data(), here, level.x.n, out.row(y).data());
}

// ---- The DEM after the bottom-up pass

Dem Pyramid::known_cells() const {
  Dem dem = fill_.dem;
  for (auto& k : dem.known.cells()) k = k != 0;
  const auto learn = [&](int col, int row, float z) {
    if (dem.known(col, row)) return;
    dem.known(col, row) = 1;
    dem.z(col, row) = z + fill_.reference_m;
  };
  const Level& cells = levels_.front();
  Desk rows = desk(cells);
  if (levels_.size() > 1)
    for (int y = 1; y < cells.y.last(); y += 2) {
      const Slot& slot = with_centres(rows, y);
      for (int x = 1; x < cells.x.last(); x += 2)
        if (slot.known[std::size_t(x)] != 0) learn(x, y, slot.height[std::size_t(x)]);
    }
  for (std::size_t k = 1; k < levels_.size(); ++k)
    for (int y = 0; y < levels_[k].y.n; ++y)
      for (int x = 0; x < levels_[k].x.n; ++x)
        if (levels_[k].weight(x, y) < 0)
          learn(levels_[k].x.cell(x), levels_[k].y.cell(y), levels_[k].z(x, y));
  return dem;
}

}  // namespace

// ---- The passes

Raster<float> displace(const Midpoint& fill, const Bend& bend, const Noise& noise,
                       std::optional<double> root_m) {
  return with_threads(fill.run.threads, [&] {
    Pyramid pyramid(fill);
    pyramid.sample();
    return pyramid.displace(bend, noise, root_m, fill.run);
  });
}

Dem carry_up_by_levels(const Midpoint& fill, const Pull& pull) {
  return with_threads(fill.run.threads, [&] {
    Pyramid pyramid(fill);
    pyramid.carry_up(pull, fill.run);
    return pyramid.known_cells();
  });
}

Raster<float> carry_up_and_displace(const Midpoint& fill, const Pull& pull, const Bend& bend,
                                    const Noise& noise) {
  return with_threads(fill.run.threads, [&] {
    Pyramid pyramid(fill);
    pyramid.carry_up(pull, fill.run.part(0, 0.5));
    return pyramid.displace(bend, noise, {}, fill.run.part(0.5, 1));
  });
}

}  // namespace dem::midpoint
