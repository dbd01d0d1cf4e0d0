#include "dem/outliers.h"

#include <algorithm>

namespace dem {
namespace {

constexpr double widths = 10, least_m = 9000;

/// Known heights, every n-th of them, so that at most a million are taken.
std::vector<float> some_heights(const Dem& dem) {
  const std::size_t step = 1 + count(dem.known) / 1000000;
  std::vector<float> heights;
  std::size_t i = 0;
  for (std::size_t cell = 0; cell < dem.size().cells(); ++cell)
    if (dem.known.cells()[cell] && i++ % step == 0) heights.push_back(dem.z.cells()[cell]);
  return heights;
}

double quantile(std::vector<float>& heights, double part) {
  const auto at = heights.begin() + std::ptrdiff_t(part * double(heights.size() - 1));
  std::ranges::nth_element(heights, at);
  return double(*at);
}

}  // namespace

Outliers find_outliers(const Dem& dem, std::size_t most_named) {
  check_fillable(dem);
  std::vector<float> heights = some_heights(dem);
  const double low = quantile(heights, 0.1), high = quantile(heights, 0.9);
  const double margin = std::max(widths * (high - low), least_m);
  Outliers found{0, {}, low - margin, high + margin};
  for (int row = 0; row < dem.size().rows; ++row)
    for (int col = 0; col < dem.size().cols; ++col) {
      const float z = dem.z(col, row);
      if (!dem.known(col, row) || (double(z) >= found.low_m && double(z) <= found.high_m)) continue;
      if (++found.count <= most_named) found.first.push_back({col, row, z});
    }
  return found;
}

}  // namespace dem
