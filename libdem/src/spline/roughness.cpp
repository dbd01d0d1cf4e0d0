#include "spline/roughness.h"

#include <cmath>

#include "dem/breaklines.h"
#include "dem/mcmd.h"
#include "numeric/parallel.h"

namespace dem::spline {
using namespace numeric;
namespace {

constexpr int block = 8;
constexpr double least = 1e-3;  // of the mean: flat ground is not certain ground

int blocks(int cells) { return (cells + block - 1) / block; }

/// Squared second differences of the surface in one cell, one cell away from the rim.
double bend(const Grid<double>& z, int x, int y, double X) {
  const double *up = z.row(y - 1), *here = z.row(y), *down = z.row(y + 1);
  const double xx = here[x - 1] - 2 * here[x] + here[x + 1], yy = up[x] - 2 * here[x] + down[x];
  const double xy = 0.25 * ((up[x - 1] - up[x + 1]) + (down[x + 1] - down[x - 1]));
  return X * X * xx * xx + 2 * X * xy * xy + yy * yy;
}

struct Mean {
  double sum = 0, n = 0;
  void add(const Mean& other) {
    sum += other.sum;
    n += other.n;
  }
};

/// The bends of the known cells in one block.
Mean mean_in_block(const Grid<double>& z, const Mask& known, const Mask& breaks, double X, int bx,
                   int by) {
  Mean mean;
  const int x1 = std::min((bx + 1) * block, known.cols() - 1);
  const int y1 = std::min((by + 1) * block, known.rows() - 1);
  for (int y = std::max(1, by * block); y < y1; ++y)
    for (int x = std::max(1, bx * block); x < x1; ++x)
      if (known(x, y) && !is_broken(breaks, x - 1, y - 1, 3, 3)) mean.add({bend(z, x, y, X), 1});
  return mean;
}

}  // namespace

Roughness::Roughness(const Grid<double>& surface, const Mask& known, const Mask& breaks, double X,
                     const Run& run) {
  const Size size{blocks(known.cols()), blocks(known.rows())};
  Raster<Mean> means(size);
  parallel_for(0, size.rows, 1, [&](int by) {
    for (int bx = 0; bx < size.cols; ++bx)
      means(bx, by) = mean_in_block(surface, known, breaks, X, bx, by);
  });
  Mean all;
  for (const Mean& m : means.cells()) all.add(m);
  const double overall = all.n > 0 ? all.sum / all.n : 0;
  if (!(overall > 0)) {
    log_ = Raster<float>(size);
    return;
  }

  Dem blurred{Raster<float>(size), Mask(size), {}, {}};
  for (int by = 0; by < size.rows; ++by)
    for (int bx = 0; bx < size.cols; ++bx) {
      Mean around;
      for (int y = std::max(0, by - 1); y <= std::min(size.rows - 1, by + 1); ++y)
        for (int x = std::max(0, bx - 1); x <= std::min(size.cols - 1, bx + 1); ++x)
          around.add(means(x, y));
      if (around.n == 0) continue;
      blurred.known(bx, by) = 1;
      blurred.z(bx, by) = float(std::log(around.sum / (around.n * overall) + least));
    }
  log_ = fill_mcmd(blurred, {}, run);
}

double Roughness::at(int col, int row) const {
  // Bilinear between the middles of the blocks.
  const auto along = [](int cell, int n) {
    const double at = std::clamp((cell + 0.5) / block - 0.5, 0., double(n - 1));
    const int first = std::min(int(at), std::max(0, n - 2));
    return std::pair(first, at - first);
  };
  const auto [x, u] = along(col, log_.cols());
  const auto [y, v] = along(row, log_.rows());
  const int right = std::min(x + 1, log_.cols() - 1), below = std::min(y + 1, log_.rows() - 1);
  const double top = (1 - u) * double(log_(x, y)) + u * double(log_(right, y));
  const double bottom = (1 - u) * double(log_(x, below)) + u * double(log_(right, below));
  return std::exp(0.5 * ((1 - v) * top + v * bottom));
}

}  // namespace dem::spline
