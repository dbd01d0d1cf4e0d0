#include "dem/greedy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace dem {
namespace {

struct Candidate {
  float error;
  int col, row;
};

/// Kept cells are about so many times as many in each round, while a count is the aim.
constexpr double growth = 1.4;

constexpr double infinite = std::numeric_limits<double>::infinity();

void keep(Dem& kept, const Dem& dem, int col, int row) {
  kept.known(col, row) = 1;
  kept.z(col, row) = dem.z(col, row);
}

/// The known cell nearest to the middle of each block of a coarse lattice; at most `most`.
Dem first_cells(const Dem& dem, std::size_t most) {
  const Size size = dem.size();
  Dem kept = dem;
  kept.known = Mask(size);
  kept.z = Raster<float>(size);
  const double share = double(std::clamp<std::size_t>(most / 4, 4, 256));
  const int block = std::max(1, int(std::ceil(std::sqrt(double(size.cells()) / share))));
  std::size_t n = 0;
  for (int top = 0; top < size.rows; top += block)
    for (int left = 0; left < size.cols; left += block) {
      int best_col = -1, best_row = -1, best = 0;
      for (int row = top; row < std::min(size.rows, top + block); ++row)
        for (int col = left; col < std::min(size.cols, left + block); ++col) {
          const int distance =
              std::abs(2 * (col - left) - block) + std::abs(2 * (row - top) - block);
          if (dem.known(col, row) && (best_col < 0 || distance < best))
            best = distance, best_col = col, best_row = row;
        }
      if (best_col < 0 || n == most) continue;
      keep(kept, dem, best_col, best_row);
      ++n;
    }
  return kept;
}

GreedyRound measure(const Dem& dem, const Dem& kept, const Raster<float>& got) {
  GreedyRound round{count(kept.known), 0, 0};
  double squares = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < got.cells().size(); ++i) {
    if (!dem.known.cells()[i]) continue;
    const double error = std::abs(double(got.cells()[i]) - double(dem.z.cells()[i]));
    squares += error * error;
    round.max_error_m = std::max(round.max_error_m, error);
    ++n;
  }
  round.rmse_m = std::sqrt(squares / double(n));
  return round;
}

/// The worst cell of each block that is missed by more than `limit`, the worst first.
std::vector<Candidate> worst_of_blocks(const Dem& dem, const Dem& kept, const Raster<float>& got,
                                       double limit) {
  const Size size = dem.size();
  const double distance = std::sqrt(double(size.cells()) / double(count(kept.known)));
  const int block = std::clamp(int(distance / 2), 1, 64);
  std::vector<Candidate> worst;
  for (int top = 0; top < size.rows; top += block)
    for (int left = 0; left < size.cols; left += block) {
      Candidate here{0, -1, -1};
      for (int row = top; row < std::min(size.rows, top + block); ++row)
        for (int col = left; col < std::min(size.cols, left + block); ++col) {
          if (!dem.known(col, row) || kept.known(col, row)) continue;
          const float error = std::abs(got(col, row) - dem.z(col, row));
          if (here.col < 0 || error > here.error) here = {error, col, row};
        }
      if (here.col >= 0 && double(here.error) > limit) worst.push_back(here);
    }
  std::ranges::stable_sort(worst, std::greater{}, &Candidate::error);
  return worst;
}

void check_for(const GreedyOptions& o, std::size_t known) {
  check_options(o);
  if ((o.count > 0) == (o.max_error_m > 0))
    throw std::invalid_argument("greedy: exactly one of count and max_error must be above 0");
  if (o.count > 0 && (o.count < 4 || o.count > known))
    throw std::invalid_argument(
        fmt::format("greedy = {}; must be in [4, {}], the known cells", o.count, known));
}

}  // namespace

std::vector<Field> fields(GreedyOptions& o) {
  return {{"count",
           o.count,
           {0, infinite},
           "cells",
           "keep exactly this number of cells; 0: as many as max_error needs"},
          {"max_error",
           o.max_error_m,
           {0, infinite},
           "m",
           "stop when no known cell is missed by more; 0: count alone decides"}};
}

GreedySample sample_greedy(const Dem& dem, const ChosenMethod& method, const GreedyOptions& options,
                           const Run& run) {
  check_fillable(dem);
  const std::size_t known = count(dem.known);
  check_for(options, known);
  const bool by_count = options.count > 0;
  const std::size_t most = by_count ? options.count : known;
  GreedySample out{first_cells(dem, most), {}};
  const Run quiet{run.threads, [&run](double, std::string_view) {
                    return !run.progress || run.progress(0, "choosing cells");
                  }};
  while (true) {
    const Raster<float> got = method.method->fill(out.dem, method.settings, quiet).z;
    out.rounds.push_back(measure(dem, out.dem, got));
    const GreedyRound& now = out.rounds.back();
    if (by_count ? now.kept >= most : now.max_error_m <= options.max_error_m) return out;
    auto worst = worst_of_blocks(dem, out.dem, got, options.max_error_m);
    const std::size_t room = most - now.kept;
    const std::size_t step =
        by_count ? std::size_t(std::ceil(double(now.kept) * (growth - 1))) : room;
    if (worst.size() > std::min(step, room)) worst.resize(std::min(step, room));
    // All that is left is met already: any cell will do.
    if (worst.empty())
      for (const Candidate& c : worst_of_blocks(dem, out.dem, got, -1))
        if (worst.size() < std::min(step, room)) worst.push_back(c);
    for (const Candidate& c : worst) keep(out.dem, dem, c.col, c.row);
  }
}

}  // namespace dem
