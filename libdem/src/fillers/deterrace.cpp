#include "dem/deterrace.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "numeric/parallel.h"

namespace dem {
using namespace numeric;
namespace {

/// Heights and where they are known, with the weights of their squared second differences.
struct Grid {
  Raster<float> h;
  Mask known;
  double xx = 1, xy = 2, yy = 1;
};

/// The mean of each 2 x 2 known cells.
Grid coarser(const Grid& fine) {
  const Size size{(fine.h.cols() + 1) / 2, (fine.h.rows() + 1) / 2};
  Grid out{Raster<float>(size), Mask(size), fine.xx, fine.xy, fine.yy};
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      double sum = 0;
      int n = 0;
      for (int y = 2 * row; y < std::min(2 * row + 2, fine.h.rows()); ++y)
        for (int x = 2 * col; x < std::min(2 * col + 2, fine.h.cols()); ++x)
          if (fine.known(x, y)) sum += double(fine.h(x, y)), ++n;
      if (n == 0) continue;
      out.h(col, row) = float(sum / n);
      out.known(col, row) = 1;
    }
  return out;
}

/// What the coarse surface differs from the coarse heights by, between the centres of its cells,
/// added to the fine heights: then the finer shapes of the fine heights remain.
Raster<float> finer(const Grid& fine, const Grid& coarse, const Raster<float>& surface) {
  Raster<float> z = fine.h;
  const auto moved = [&](int x, int y) {
    x = std::clamp(x, 0, surface.cols() - 1), y = std::clamp(y, 0, surface.rows() - 1);
    return coarse.known(x, y) ? surface(x, y) - coarse.h(x, y) : 0;
  };
  for (int row = 0; row < z.rows(); ++row)
    for (int col = 0; col < z.cols(); ++col) {
      // The nearest coarse cell counts 9/16, its neighbours 3/16, 3/16 and 1/16.
      const int x = col / 2, y = row / 2, dx = col % 2 == 0 ? -1 : 1, dy = row % 2 == 0 ? -1 : 1;
      z(col, row) +=
          (9 * moved(x, y) + 3 * (moved(x + dx, y) + moved(x, y + dy)) + moved(x + dx, y + dy)) /
          16;
    }
  return z;
}

/// The gradient of the plate's energy, row by row.
class Plate {
 public:
  explicit Plate(const Grid& grid) : g_(grid) {}

  /// Above the largest eigenvalue of the energy's matrix.
  double largest() const { return 16 * (g_.xx + g_.xy + g_.yy); }

  double gradient(const Raster<float>& z, int c, int r) const {
    return g_.xx * (zxx(z, c - 1, r) - 2 * zxx(z, c, r) + zxx(z, c + 1, r)) +
           g_.yy * (zyy(z, c, r - 1) - 2 * zyy(z, c, r) + zyy(z, c, r + 1)) +
           g_.xy * (zxy(z, c - 1, r - 1) - zxy(z, c, r - 1) - zxy(z, c - 1, r) + zxy(z, c, r));
  }

 private:
  bool known(int c, int r) const { return g_.known.contains(c, r) && g_.known(c, r); }
  /// Second differences; 0 where they reach beyond what is known.
  double zxx(const Raster<float>& z, int c, int r) const {
    if (!known(c - 1, r) || !known(c, r) || !known(c + 1, r)) return 0;
    return double(z(c - 1, r)) - 2 * double(z(c, r)) + double(z(c + 1, r));
  }
  double zyy(const Raster<float>& z, int c, int r) const {
    if (!known(c, r - 1) || !known(c, r) || !known(c, r + 1)) return 0;
    return double(z(c, r - 1)) - 2 * double(z(c, r)) + double(z(c, r + 1));
  }
  double zxy(const Raster<float>& z, int c, int r) const {
    if (!known(c, r) || !known(c + 1, r) || !known(c, r + 1) || !known(c + 1, r + 1)) return 0;
    return double(z(c, r)) - double(z(c + 1, r)) - double(z(c, r + 1)) + double(z(c + 1, r + 1));
  }

  const Grid& g_;
};

/// Improves z within its bounds, by projected gradients with momentum [beck2009].
void relax(const Grid& grid, double bound, int passes, Raster<float>& z, const Run& run) {
  const Plate plate(grid);
  const double step = 1 / plate.largest();
  Raster<float> ahead = z, next = z;
  double t = 1;
  for (int pass = 0; pass < passes; ++pass) {
    run.report(double(pass) / passes, "smoothing steps");
    const double t_next = (1 + std::sqrt(1 + 4 * t * t)) / 2, momentum = (t - 1) / t_next;
    t = t_next;
    parallel_for(0, z.rows(), 16, [&](int row) {
      for (int col = 0; col < z.cols(); ++col) {
        if (!grid.known(col, row)) continue;
        const double h = double(grid.h(col, row));
        const double moved = double(ahead(col, row)) - step * plate.gradient(ahead, col, row);
        next(col, row) = float(std::clamp(moved, h - bound, h + bound));
      }
    });
    parallel_for(0, z.rows(), 16, [&](int row) {
      for (int col = 0; col < z.cols(); ++col) {
        const float now = next(col, row);
        ahead(col, row) = now + float(momentum) * (now - z(col, row));
        z(col, row) = now;
      }
    });
  }
}

/// Float rounding may carry a height past its bound.
float within(double z, float h, double bound) {
  float out = float(z);
  while (std::abs(double(out) - double(h)) > bound) out = std::nextafter(out, h);
  return out;
}

}  // namespace

std::vector<Field> fields(DeterraceOptions& o) {
  return {{"bound", o.bound_m, {0, 1e6}, "m", "no cell moves by more"},
          {"passes", o.passes, {1, 100000}, "", "of relaxation on each grid"}};
}

Deterraced deterrace(const Dem& dem, const DeterraceOptions& options, const Run& run) {
  check_shape(dem);
  check_options(options);
  const double X = std::pow(dem.spacing.dy_m / dem.spacing.dx_m, 2);
  constexpr int coarsest = 8;
  std::vector<Grid> grids{{dem.z, dem.known, X * X, 2 * X, 1}};
  while (std::min(grids.back().h.cols(), grids.back().h.rows()) > 2 * coarsest)
    grids.push_back(coarser(grids.back()));

  Deterraced out;
  with_threads(run.threads, [&] {
    for (std::size_t l = grids.size(); l-- > 0;) {
      const bool last = l == 0;
      out.z = l + 1 == grids.size() ? grids[l].h : finer(grids[l], grids[l + 1], out.z);
      for (std::size_t i = 0; i < out.z.cells().size(); ++i) {
        const double h = double(grids[l].h.cells()[i]);
        float& z = out.z.cells()[i];
        z = grids[l].known.cells()[i]
                ? float(std::clamp(double(z), h - options.bound_m, h + options.bound_m))
                : float(h);
      }
      relax(grids[l], options.bound_m, options.passes, out.z,
            last ? run.part(0.25, 1)
                 : run.part(0.25 - 0.25 / double(1 << (grids.size() - 1 - l)),
                            0.25 - 0.125 / double(1 << (grids.size() - 1 - l))));
    }
  });
  double squares = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < out.z.cells().size(); ++i) {
    if (!dem.known.cells()[i]) continue;
    const float h = dem.z.cells()[i];
    out.z.cells()[i] = within(double(out.z.cells()[i]), h, options.bound_m);
    const double moved = std::abs(double(out.z.cells()[i]) - double(h));
    squares += moved * moved;
    out.moved_max_m = std::max(out.moved_max_m, moved);
    ++n;
  }
  if (n > 0) out.moved_rms_m = std::sqrt(squares / double(n));
  return out;
}

}  // namespace dem
