#include "dem/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace dem {
namespace {

constexpr std::size_t kMostCells = std::size_t(1) << 30;

bool is_length(double metres) { return std::isfinite(metres) && metres > 0; }

/// Centre of a cell along one axis, in metres: `step` CRS units are `cell_m`.
double place_m(double first, double step, int index, double cell_m) {
  return (first / std::abs(step) + (step > 0 ? index : -index)) * cell_m;
}

}  // namespace

double Canvas::east_m(int col) const {
  return place_m(ref.to_world[0], ref.to_world[1], col, spacing.dx_m);
}

double Canvas::north_m(int row) const {
  return place_m(ref.to_world[3], ref.to_world[5], row, spacing.dy_m);
}

void check_canvas(const Canvas& canvas) {
  const auto [cols, rows] = canvas.size;
  if (cols < 1 || rows < 1 || canvas.size.cells() > kMostCells)
    throw std::invalid_argument(
        fmt::format("size = {} x {}; must have 1 to {} cells", cols, rows, kMostCells));
  const auto [dx, dy] = canvas.spacing;
  if (!is_length(dx) || !is_length(dy))
    throw std::invalid_argument(
        fmt::format("spacing = {} x {} m; must be finite and above 0", dx, dy));
  const auto& at = canvas.ref.to_world;
  const bool finite = std::ranges::all_of(at, [](double v) { return std::isfinite(v); });
  if (!finite || at[1] == 0 || at[5] == 0 || at[2] != 0 || at[4] != 0)
    throw std::invalid_argument(
        fmt::format("to_world = ({}); must be finite, with rows along x and columns along y",
                    fmt::join(at, ", ")));
}

Dem on_canvas(const Canvas& canvas, Raster<float> z) {
  return {std::move(z), Mask(canvas.size, 1), canvas.ref, canvas.spacing};
}

}  // namespace dem
