#include "dem/sample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "numeric/gradient.h"
#include "numeric/parallel.h"
#include "numeric/random.h"

namespace dem {
using namespace numeric;
namespace {

/// Tells the draws of this file apart from other uses of the same seed.
enum Stream : std::uint64_t { kRandom = 0x5a4d0001, kTies, kVoids, kTracks };

/// The cells of `dem` that `keep` marks; the others' heights are wiped, so that none can leak.
Dem only(const Dem& dem, Mask keep, const char* what, double value) {
  Dem out{Raster<float>(dem.size()), std::move(keep), dem.ref, dem.spacing};
  bool any = false;
  for (std::size_t i = 0; i < out.known.cells().size(); ++i) {
    auto& known = out.known.cells()[i];
    known = known && dem.known.cells()[i];
    if (known) out.z.cells()[i] = dem.z.cells()[i];
    any = any || known;
  }
  if (!any)
    throw std::invalid_argument(
        fmt::format("{} = {}; must leave at least one known cell, and leaves none", what, value));
  return out;
}

void check_count(const char* name, std::size_t value, std::size_t least, std::size_t most) {
  if (value < least || value > most)
    throw std::invalid_argument(fmt::format(
        "{} = {}; must be in [{}, {}] for the known cells there are", name, value, least, most));
}

void check_least(const char* name, int value, int least) {
  if (value < least)
    throw std::invalid_argument(fmt::format("{} = {}; must be >= {}", name, value, least));
}

/// Draws cells of steep ground: the chance of a cell is proportional to its squared gradient.
class SteepCells {
 public:
  explicit SteepCells(const Dem& dem) : dem_(dem), up_to_(std::size_t(dem.size().rows)) {
    parallel_for(0, dem.size().rows, 16, [&](int row) {
      double sum = 0;
      for (int col = 0; col < dem_.size().cols; ++col) sum += weight(col, row);
      up_to_[std::size_t(row)] = sum;
    });
    double sum = 0;
    for (auto& row : up_to_) row = sum += row;
  }

  bool none() const { return up_to_.back() == 0; }

  Cell draw(Sequence& random) const {
    const double aim = double(random.bits() >> 11) / 9007199254740992.0 * up_to_.back();
    const auto found = std::ranges::upper_bound(up_to_, aim);
    const int row = int(std::min(found, up_to_.end() - 1) - up_to_.begin());
    double sum = row == 0 ? 0 : up_to_[std::size_t(row) - 1];
    int last = 0;
    for (int col = 0; col < dem_.size().cols; ++col) {
      const double w = weight(col, row);
      if (w > 0) last = col;
      sum += w;
      if (sum > aim) break;
    }
    return {last, row};
  }

 private:
  double weight(int col, int row) const {
    return dem_.known(col, row) ? GradientOf(dem_.z, dem_.known, dem_.spacing)(col, row).squared()
                                : 0;
  }

  const Dem& dem_;
  std::vector<double> up_to_;  // sum of the weights to the end of each row
};

/// least * (most / least)^u for a uniform u of 16 bits, by square roots only.
double log_uniform(double least, double most, Sequence& random) {
  const std::uint64_t bits = random.bits();
  double size = least, step = most / least;
  for (int i = 0; i < 16; ++i) {
    step = std::sqrt(step);
    if (bits >> i & 1) size *= step;
  }
  return size;
}

/// Removes up to `area` cells around `start` from `keep`; returns how many. The blob is a chain of
/// bursts: each begins at a random cell of the blob's rim and grows by one random cell of its own
/// rim at a time (Eden growth). One burst alone would be nearly round.
std::size_t cut_blob(Mask& keep, Cell start, std::size_t area, Sequence& random,
                     std::vector<Cell>& rim) {
  std::size_t cut = 0, burst_ends = 0, burst_rim = 0;  // the burst's rim: rim[burst_rim] and on
  rim.assign(1, start);
  while (cut < area && !rim.empty()) {
    if (cut >= burst_ends || burst_rim == rim.size()) {
      std::swap(rim[std::size_t(random.below(rim.size()))], rim.back());
      burst_rim = rim.size() - 1;
      burst_ends = cut + 1 + std::size_t(random.below(area / 6 + 1));
    }
    const auto at = burst_rim + std::size_t(random.below(rim.size() - burst_rim));
    const Cell cell = rim[at];
    rim[at] = rim.back();
    rim.pop_back();
    if (!keep(cell.col, cell.row)) continue;
    keep(cell.col, cell.row) = 0;
    ++cut;
    for (const auto [dc, dr] : {Cell{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      if (const Cell next{cell.col + dc, cell.row + dr};
          keep.contains(next.col, next.row) && keep(next.col, next.row))
        rim.push_back(next);
  }
  return cut;
}

/// A random cell of one side: 0 north, 1 east, 2 south, 3 west.
Cell on_side(std::uint64_t side, Size size, Sequence& random) {
  const int col = int(random.below(std::uint64_t(size.cols)));
  const int row = int(random.below(std::uint64_t(size.rows)));
  switch (side) {
    case 0:
      return {col, 0};
    case 1:
      return {size.cols - 1, row};
    case 2:
      return {col, size.rows - 1};
    default:
      return {0, row};
  }
}

/// Marks the cells nearest to the straight line from a to b, one for each step along its longer
/// axis.
void mark_line(Mask& mask, Cell a, Cell b) {
  const std::int64_t dc = b.col - a.col, dr = b.row - a.row;
  const std::int64_t steps = std::max(std::abs(dc), std::abs(dr));
  mask(a.col, a.row) = 1;
  const auto part = [steps](std::int64_t whole, std::int64_t i) {  // whole * i / steps, rounded
    const std::int64_t twice = 2 * std::abs(whole) * i + steps;
    return int(whole < 0 ? -(twice / (2 * steps)) : twice / (2 * steps));
  };
  for (std::int64_t i = 1; i <= steps; ++i) mask(a.col + part(dc, i), a.row + part(dr, i)) = 1;
}

/// Whether the level nearest to z passes between a cell of height z and a neighbour of height n,
/// and nearer to the cell.
bool level_passes(double z, double n, double level) {
  const double e = z - level, f = n - level;
  return z != n && e * f <= 0 && std::abs(e) <= std::abs(f);
}

}  // namespace

Dem sample_random(const Dem& dem, std::size_t keep, std::uint64_t seed) {
  check_fillable(dem);
  std::size_t left = count(dem.known), wanted = keep;
  check_count("keep", keep, 1, left);
  // Selection in one pass: each known cell is taken with the chance wanted / left.
  Mask mask(dem.size());
  for (int row = 0; row < dem.size().rows; ++row)
    for (int col = 0; col < dem.size().cols; ++col) {
      if (!dem.known(col, row)) continue;
      if (below(random_bits(seed, kRandom, col, row), left) < wanted) {
        mask(col, row) = 1;
        --wanted;
      }
      --left;
    }
  return only(dem, std::move(mask), "keep", double(keep));
}

Dem sample_regular(const Dem& dem, int step) {
  check_fillable(dem);
  check_least("step", step, 1);
  Mask mask(dem.size());
  for (std::int64_t row = 0; row < dem.size().rows; row += step)
    for (std::int64_t col = 0; col < dem.size().cols; col += step) mask(int(col), int(row)) = 1;
  return only(dem, std::move(mask), "step", step);
}

Dem sample_edges(const Dem& dem, std::size_t keep) {
  check_fillable(dem);
  check_count("keep", keep, 1, count(dem.known));
  // Squared gradients; unknown cells stand behind all others.
  Raster<double> strength(dem.size(), -1.0);
  const GradientOf gradient(dem.z, dem.known, dem.spacing);
  parallel_for(0, dem.size().rows, 16, [&](int row) {
    for (int col = 0; col < dem.size().cols; ++col)
      if (dem.known(col, row)) strength(col, row) = gradient(col, row).squared();
  });

  // The keep-th strongest is the threshold: all above it stay, of those equal to it a hash decides.
  std::vector<double> order(strength.cells().begin(), strength.cells().end());
  const auto last = order.begin() + std::ptrdiff_t(keep - 1);
  std::nth_element(order.begin(), last, order.end(), std::greater<>());
  const double threshold = *last;
  Mask mask(dem.size());
  std::size_t kept = 0;
  struct Tie {
    std::uint64_t hash;
    Cell cell;
  };
  std::vector<Tie> ties;
  for (int row = 0; row < dem.size().rows; ++row)
    for (int col = 0; col < dem.size().cols; ++col)
      if (strength(col, row) > threshold)
        mask(col, row) = 1, ++kept;
      else if (strength(col, row) == threshold)
        ties.push_back({random_bits(0, kTies, col, row), {col, row}});
  const auto end = ties.begin() + std::ptrdiff_t(keep - kept);
  std::nth_element(ties.begin(), end, ties.end(), [](const Tie& a, const Tie& b) {
    return std::tuple(a.hash, a.cell.row, a.cell.col) < std::tuple(b.hash, b.cell.row, b.cell.col);
  });
  for (auto tie = ties.begin(); tie != end; ++tie) mask(tie->cell.col, tie->cell.row) = 1;
  return only(dem, std::move(mask), "keep", double(keep));
}

std::vector<Field> fields(VoidOptions& o) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  return {{"remove", o.remove, {0, infinite}, "cells", "number of known cells to cut out"},
          {"min_across", o.min_across, {1, infinite}, "cells", "width of the smallest voids"},
          {"max_across",
           o.max_across,
           {1, infinite},
           "cells",
           "width of the largest voids; not below min_across"},
          {"seed", o.seed, "seed of the voids' places and shapes"}};
}

Dem sample_voids(const Dem& dem, const VoidOptions& options) {
  check_fillable(dem);
  check_options(options);
  check_count("remove", options.remove, 0, count(dem.known) - 1);
  check_least("max_across", options.max_across, options.min_across);
  Mask mask = dem.known;
  const SteepCells steep(dem);
  Sequence random(options.seed, kVoids);
  std::vector<Cell> rim;
  std::size_t gone = 0;
  for (bool on_steep = false; gone < options.remove; on_steep = !on_steep) {
    // A start that is still known: steep ground may be used up, then any.
    std::optional<Cell> start;
    for (int i = 0; i < 8 && on_steep && !steep.none() && !start; ++i)
      if (const Cell cell = steep.draw(random); mask(cell.col, cell.row)) start = cell;
    while (!start)
      if (const Cell cell{int(random.below(std::uint64_t(dem.size().cols))),
                          int(random.below(std::uint64_t(dem.size().rows)))};
          mask(cell.col, cell.row))
        start = cell;

    const double across = log_uniform(options.min_across, options.max_across, random);
    const double area = std::max(1.0, std::floor(std::numbers::pi / 4 * across * across + 0.5));
    gone += cut_blob(mask, *start, std::min(std::size_t(area), options.remove - gone), random, rim);
  }
  return only(dem, std::move(mask), "remove", double(options.remove));
}

Dem sample_tracks(const Dem& dem, int tracks, std::uint64_t seed) {
  check_fillable(dem);
  check_least("tracks", tracks, 1);
  Mask mask(dem.size());
  Sequence random(seed, kTracks);
  for (int i = 0; i < tracks; ++i) {
    const std::uint64_t from = random.below(4), to = (from + 1 + random.below(3)) % 4;
    const Cell a = on_side(from, dem.size(), random), b = on_side(to, dem.size(), random);
    mark_line(mask, a, b);
  }
  return only(dem, std::move(mask), "tracks", tracks);
}

Dem sample_contours(const Dem& dem, double interval_m) {
  check_fillable(dem);
  if (!(interval_m > 0) || !std::isfinite(interval_m))
    throw std::invalid_argument(fmt::format("interval_m = {}; must be > 0", interval_m));
  Dem levels = dem;
  Mask mask(dem.size());
  parallel_for(0, dem.size().rows, 16, [&](int row) {
    for (int col = 0; col < dem.size().cols; ++col) {
      if (!dem.known(col, row)) continue;
      const double z = dem.z(col, row);
      const double level = std::nearbyint(z / interval_m) * interval_m + 0.0;  // + 0: no minus zero
      levels.z(col, row) = float(level);
      for (const auto [dc, dr] : {Cell{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        if (dem.z.contains(col + dc, row + dr) && dem.known(col + dc, row + dr) &&
            level_passes(z, dem.z(col + dc, row + dr), level))
          mask(col, row) = 1;
    }
  });
  return only(levels, std::move(mask), "interval_m", interval_m);
}

}  // namespace dem
