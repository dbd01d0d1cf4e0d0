#include "dem/breakdown.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "numeric/distance.h"

namespace dem {
using namespace numeric;
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void check_size(const char* name, Size size, Size expected) {
  if (size != expected)
    throw std::invalid_argument(fmt::format("{} is {} x {}; must be {} x {}", name, size.cols,
                                            size.rows, expected.cols, expected.rows));
}

}  // namespace

Histogram histogram(const Raster<float>& values, const Mask& where, double low, double high,
                    int bins) {
  check_size("where", where.size(), values.size());
  if (!(low < high)) throw std::invalid_argument(fmt::format("low = {}; must be < {}", low, high));
  if (bins < 1) throw std::invalid_argument(fmt::format("bins = {}; must be >= 1", bins));
  Histogram h{low, high, std::vector<std::size_t>(std::size_t(bins)), 0, 0};
  for (std::size_t i = 0; i < values.cells().size(); ++i) {
    if (!where.cells()[i]) continue;
    const double v = double(values.cells()[i]);
    if (v < low)
      ++h.below;
    else if (v > high)
      ++h.above;
    else
      ++h.cells[std::min(std::size_t((v - low) / h.width()), h.cells.size() - 1)];
  }
  return h;
}

std::vector<double> quantiles(const Raster<float>& values, const Mask& where,
                              std::span<const double> parts) {
  check_size("where", where.size(), values.size());
  std::vector<float> chosen;
  chosen.reserve(count(where));
  for (std::size_t i = 0; i < values.cells().size(); ++i)
    if (where.cells()[i]) chosen.push_back(values.cells()[i]);
  if (chosen.empty())
    throw std::invalid_argument("where has no cell that is 1; at least one is needed");
  std::vector<double> found;
  for (const double part : parts) {
    if (!(part >= 0 && part <= 1))
      throw std::invalid_argument(fmt::format("part = {}; must be in [0, 1]", part));
    const double rank = std::ceil(part * double(chosen.size()));
    const auto at = chosen.begin() + std::ptrdiff_t(std::max(rank, 1.0)) - 1;
    std::ranges::nth_element(chosen, at);
    found.push_back(double(*at));
  }
  return found;
}

std::vector<ErrorClass> errors_by(const Raster<float>& error, const Mask& where,
                                  const Raster<float>& by, std::span<const double> bounds) {
  check_size("where", where.size(), error.size());
  check_size("by", by.size(), error.size());
  if (bounds.size() < 2 || !std::ranges::is_sorted(bounds))
    throw std::invalid_argument(
        fmt::format("bounds = {}; must be two or more, ascending", fmt::join(bounds, ", ")));

  struct Sums {
    double e = 0, squares = 0, by_squares = 0;
  };
  std::vector<ErrorClass> classes(bounds.size() - 1);
  std::vector<Sums> sums(classes.size());
  for (std::size_t i = 0; i < error.cells().size(); ++i) {
    const double b = double(by.cells()[i]), e = double(error.cells()[i]);
    if (!where.cells()[i] || !(b >= bounds.front() && b < bounds.back())) continue;
    const auto c = std::size_t(std::ranges::upper_bound(bounds, b) - bounds.begin()) - 1;
    ++classes[c].cells;
    sums[c].e += e;
    sums[c].squares += e * e;
    sums[c].by_squares += b * b;
  }
  for (std::size_t c = 0; c < classes.size(); ++c) {
    const double n = classes[c].cells > 0 ? double(classes[c].cells) : kNaN;
    classes[c] = {bounds[c],        bounds[c + 1],
                  classes[c].cells, std::sqrt(sums[c].squares / n),
                  sums[c].e / n,    std::sqrt(sums[c].by_squares / n)};
  }
  return classes;
}

Raster<float> distance_to_known(const Mask& known, Spacing spacing) {
  if (count(known) == 0)
    throw std::invalid_argument("known has no cell that is 1; at least one is needed");
  if (!(spacing.dx_m > 0 && spacing.dy_m > 0))
    throw std::invalid_argument(
        fmt::format("spacing = {} x {} m; must be > 0", spacing.dx_m, spacing.dy_m));

  // Down and up each column to the nearest known cell, a row at a time; then along the rows.
  constexpr float far = std::numeric_limits<float>::infinity();
  Raster<float> distance(known.size());
  const auto pass = [&](int row, int from) {
    for (int col = 0; col < known.cols(); ++col) {
      const float before =
          known.contains(col, from) ? distance(col, from) + float(spacing.dy_m) : far;
      distance(col, row) =
          known(col, row) ? 0 : std::min(row > from ? far : distance(col, row), before);
    }
  };
  for (int row = 0; row < known.rows(); ++row) pass(row, row - 1);
  for (int row = known.rows(); row-- > 0;) pass(row, row + 1);

  Envelope envelope;
  std::vector<double> line(std::size_t(known.cols()));
  for (int row = 0; row < known.rows(); ++row) {
    const auto cells = distance.row(row);
    std::ranges::transform(cells, line.begin(), [](float d) { return double(d) * double(d); });
    envelope.apply(line, spacing.dx_m * spacing.dx_m);
    std::ranges::transform(line, cells.begin(), [](double d) { return float(std::sqrt(d)); });
  }
  return distance;
}

}  // namespace dem
