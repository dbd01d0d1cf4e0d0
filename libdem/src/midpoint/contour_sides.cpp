#include "midpoint/contour_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "numeric/parallel.h"

namespace dem::midpoint {
using namespace numeric;
namespace {

constexpr int farthest = 48;  // cells that a contour cell looks around
constexpr int reach = 2;      // cells on either side of a line that become known

/// The nearest known cell above (or below) a contour cell.
struct Nearest {
  int dx = 0, dy = 0;
  double distance = std::numeric_limits<double>::infinity();
  double step = 0;  ///< how much higher (lower) it lies

  bool found() const { return step > 0; }
  void see(int x, int y, double difference) {
    const double d = std::hypot(x, y);
    if (d < distance) *this = {x, y, d, difference};
  }
};

/// The plane on either side of a contour cell.
struct Sides {
  double uphill_x = 0, uphill_y = 0;  ///< of length 1; 0: nothing is known
  double rise = 0, fall = 0;          ///< metres a cell
  double most_rise = 0, most_fall = 0;

  double at(int dx, int dy) const {
    const double along = uphill_x * dx + uphill_y * dy;
    return along >= 0 ? std::min(rise * along, most_rise) : -std::min(-fall * along, most_fall);
  }
};

/// Calls each(x, y) for the known cells on the square ring of radius r around a cell.
template <class Each>
void for_ring(const Mask& known, int col, int row, int r, const Each& each) {
  const auto look = [&](int x, int y) {
    if (known.contains(x, y) && known(x, y)) each(x, y);
  };
  for (int x = col - r; x <= col + r; ++x) look(x, row - r), look(x, row + r);
  for (int y = row - r + 1; y < row + r; ++y) look(col - r, y), look(col + r, y);
}

Sides sides_of(const Dem& dem, int col, int row) {
  const double here = double(dem.z(col, row));
  Nearest above, below;
  for (int r = 1; r <= farthest && !(r > above.distance && r > below.distance); ++r)
    for_ring(dem.known, col, row, r, [&](int x, int y) {
      const double difference = double(dem.z(x, y)) - here;
      if (difference > 0) above.see(x - col, y - row, difference);
      if (difference < 0) below.see(x - col, y - row, -difference);
    });
  Sides sides;
  if (above.found()) {
    sides.uphill_x += above.dx / above.distance;
    sides.uphill_y += above.dy / above.distance;
  }
  if (below.found()) {
    sides.uphill_x -= below.dx / below.distance;
    sides.uphill_y -= below.dy / below.distance;
  }
  const double length = std::hypot(sides.uphill_x, sides.uphill_y);
  if (length < 0.1) return {};
  sides.uphill_x /= length;
  sides.uphill_y /= length;
  constexpr double most_of_step = 0.95, beyond_the_last = 0.5;
  const Nearest& up = above.found() ? above : below;
  const Nearest& down = below.found() ? below : above;
  sides.rise = up.step / up.distance;
  sides.fall = down.step / down.distance;
  sides.most_rise = up.step * (above.found() ? most_of_step : beyond_the_last);
  sides.most_fall = down.step * (below.found() ? most_of_step : beyond_the_last);
  return sides;
}

Dem add_sides(const Dem& dem, const Run& run) {
  const Size size = dem.size();
  Raster<Sides> sides(size);
  for (int from = 0; from < size.rows; from += 128) {
    run.report(double(from) / size.rows, "sides of contour lines");
    parallel_for(from, std::min(size.rows, from + 128), 4, [&](int row) {
      for (int col = 0; col < size.cols; ++col)
        if (dem.known(col, row)) sides(col, row) = sides_of(dem, col, row);
    });
  }
  Dem out = dem;
  parallel_for(0, size.rows, 16, [&](int row) {
    for (int col = 0; col < size.cols; ++col) {
      if (dem.known(col, row)) continue;
      double sum = 0, weights = 0;
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          if (!sides.contains(col + dx, row + dy) || !dem.known(col + dx, row + dy)) continue;
          const Sides& s = sides(col + dx, row + dy);
          if (s.uphill_x == 0 && s.uphill_y == 0) continue;
          const double weight = 1. / (dx * dx + dy * dy);
          sum += weight * (double(dem.z(col + dx, row + dy)) + s.at(-dx, -dy));
          weights += weight;
        }
      if (weights == 0) continue;
      out.z(col, row) = float(sum / weights);
      out.known(col, row) = 1;
    }
  });
  return out;
}

}  // namespace

Dem with_contour_sides(const Dem& dem, const Run& run) {
  return with_threads(run.threads, [&] { return add_sides(dem, run); });
}

}  // namespace dem::midpoint
