#include "dem/baseline.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "numeric/parallel.h"

namespace dem {
using namespace numeric;
namespace {

constexpr int kRowsAtOnce = 64;
constexpr std::int32_t kNone = -1;
constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();

/// Weights that make a squared distance x * dc^2 + y * dr^2 a whole number below 2^61: equal
/// distances are then equal numbers. They are dx^2 and dy^2 times the same power of two, rounded.
struct Weights {
  std::int64_t x = 1;
  std::int64_t y = 1;
};

Weights weights_of(Spacing cell, Size size) {
  if (!(cell.dx_m > 0 && cell.dy_m > 0 && std::isfinite(cell.dx_m) && std::isfinite(cell.dy_m)))
    throw std::invalid_argument(
        fmt::format("dem.spacing = {} x {} m; must be > 0", cell.dx_m, cell.dy_m));
  const double longest =
      std::max(size.cols, size.rows) * std::max(cell.dx_m, cell.dy_m);  // of either side
  const int power = 59 - std::ilogb(longest * longest);
  const auto weight = [&](double length) {
    return std::max<std::int64_t>(1, std::llrint(std::ldexp(length * length, power)));
  };
  return {weight(cell.dx_m), weight(cell.dy_m)};
}

/// For each cell the nearest known one of its column: its distance in rows (kNone: there is none)
/// and its height. `begin` to `end` are columns.
void nearest_in_columns(const Dem& dem, int begin, int end, Raster<std::int32_t>& rows_away,
                        Raster<float>& z) {
  const int rows = dem.size().rows;
  // Down: the last known cell above.
  for (int row = 0; row < rows; ++row)
    for (int col = begin; col < end; ++col) {
      if (dem.known(col, row)) {
        rows_away(col, row) = 0;
        z(col, row) = dem.z(col, row);
      } else if (row > 0 && rows_away(col, row - 1) != kNone) {
        rows_away(col, row) = rows_away(col, row - 1) + 1;
        z(col, row) = z(col, row - 1);
      }
    }
  // Up: the next known cell below, when it is nearer, or as near and lower.
  for (int row = rows - 2; row >= 0; --row)
    for (int col = begin; col < end; ++col) {
      if (rows_away(col, row + 1) == kNone) continue;
      const std::int32_t away = rows_away(col, row + 1) + 1, now = rows_away(col, row);
      if (now == kNone || away < now || (away == now && z(col, row + 1) < z(col, row))) {
        rows_away(col, row) = away;
        z(col, row) = z(col, row + 1);
      }
    }
}

/// One column's candidate in a row: at column c its squared distance is height + x * (c - col)^2.
struct Parabola {
  std::int64_t col, height;
  std::int64_t from;  // the first column where it is not above the one before it
  float z;

  std::int64_t at(std::int64_t c, std::int64_t x) const {
    return height + x * (c - col) * (c - col);
  }
};

std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return a / b + (a % b > 0); }

/// Replaces each height of a row by that of the lowest parabola there; of equally low ones the
/// smaller height.
void lower_envelope(std::span<const std::int32_t> rows_away, std::span<float> z, Weights weights,
                    std::vector<Parabola>& envelope) {
  envelope.clear();
  for (std::size_t c = 0; c < z.size(); ++c) {
    if (rows_away[c] == kNone) continue;
    const std::int64_t away = rows_away[c];
    Parabola next{std::int64_t(c), weights.y * away * away, kFirst, z[c]};
    // One that this one undercuts before it had its turn never is the lowest. One that only touches
    // the envelope in a column stays: it may win there by its smaller height.
    while (!envelope.empty()) {
      const Parabola& last = envelope.back();
      const std::int64_t columns = next.col - last.col;
      next.from = ceil_div(next.height - last.height + weights.x * (next.col + last.col) * columns,
                           2 * weights.x * columns);
      if (next.from >= last.from) break;
      envelope.pop_back();
    }
    if (envelope.empty()) next.from = kFirst;
    if (next.from < std::int64_t(z.size())) envelope.push_back(next);
  }

  std::size_t k = 0;
  for (std::int64_t c = 0; c < std::int64_t(z.size()); ++c) {
    while (k + 1 < envelope.size() && envelope[k + 1].from <= c) ++k;
    float lowest = envelope[k].z;
    for (std::size_t j = k; j > 0 && envelope[j].from == c; --j) {
      if (envelope[j - 1].at(c, weights.x) != envelope[k].at(c, weights.x)) break;
      lowest = std::min(lowest, envelope[j - 1].z);
    }
    z[std::size_t(c)] = lowest;
  }
}

}  // namespace

std::vector<Field> fields(NearestOptions&) { return {}; }

Raster<float> fill_nearest(const Dem& dem, const NearestOptions&, const Run& run) {
  check_fillable(dem);
  const Size size = dem.size();
  const Weights weights = weights_of(dem.spacing, size);
  Raster<float> z(size);
  Raster<std::int32_t> rows_away(size, kNone);

  // Along columns, in bands wide enough for whole cache lines.
  run.report(0, "columns");
  constexpr int kBand = 256;
  with_threads(run.threads, [&] {
    parallel_for(0, (size.cols + kBand - 1) / kBand, 1, [&](int band) {
      nearest_in_columns(dem, band * kBand, std::min(size.cols, (band + 1) * kBand), rows_away, z);
    });
  });

  // Along rows.
  const int bands = (size.rows + kRowsAtOnce - 1) / kRowsAtOnce;
  constexpr int kBandsAtOnce = 16;
  for (int first = 0; first < bands; first += kBandsAtOnce) {
    run.report(0.4 + 0.6 * first / bands, "rows");
    with_threads(run.threads, [&] {
      parallel_for(first, std::min(bands, first + kBandsAtOnce), 1, [&](int band) {
        std::vector<Parabola> envelope;
        const int end = std::min(size.rows, (band + 1) * kRowsAtOnce);
        for (int row = band * kRowsAtOnce; row < end; ++row)
          lower_envelope(rows_away.row(row), z.row(row), weights, envelope);
      });
    });
  }
  run.report(1, "rows");
  return z;
}

}  // namespace dem
