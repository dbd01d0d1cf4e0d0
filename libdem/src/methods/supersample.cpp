#include "dem/supersample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dem/gridding.h"
#include "numeric/cubic.h"

namespace dem {
using namespace numeric;
namespace {

/// Along one axis: coarse index = origin + step * fine index.
struct Axis {
  int cells = 0;
  double origin = 0, step = 1;
  double to_fine(double coarse) const { return (coarse - origin) / step; }
};

Axis finer_axis(int cells, const SupersampleOptions& o) {
  const int whole = o.nodes ? cells - 1 : cells;  // coarse steps between the ends
  const double fine = std::max(1., std::round(whole * o.factor));
  if (fine > 2147483646)
    throw std::invalid_argument(
        fmt::format("factor = {}; must leave fewer than 2^31 cells", o.factor));
  Axis axis;
  axis.step = whole > 0 ? whole / fine : 1;
  axis.cells = int(fine) + (o.nodes ? 1 : 0);
  axis.origin = o.nodes ? 0 : axis.step / 2 - 0.5;
  return axis;
}

struct Axes {
  Axis x, y;
};

Axes finer_axes(Size size, const SupersampleOptions& o) {
  check_options(o);
  const Axes axes{finer_axis(size.cols, o), finer_axis(size.rows, o)};
  if (double(axes.x.cells) * axes.y.cells > 2147483647.)
    throw std::invalid_argument(fmt::format("factor = {}: {} x {} cells; must be fewer than 2^31",
                                            o.factor, axes.x.cells, axes.y.cells));
  return axes;
}

/// The coarse heights as points of the finer lattice, whose own units are its columns and rows.
Points points_of(const Dem& dem, const Axes& axes) {
  Points p;
  for (int row = 0; row < dem.size().rows; ++row)
    for (int col = 0; col < dem.size().cols; ++col) {
      if (!dem.known(col, row)) continue;
      p.x.push_back(axes.x.to_fine(col));
      p.y.push_back(-axes.y.to_fine(row));
      p.z.push_back(dem.z(col, row));
    }
  return p;
}

/// Which fine cells a coarse cell covers, and by how much of each.
struct Cover {
  int begin, end;
  double first, last;  // parts of the first and last one
  double weight(int i) const { return i == begin ? first : i + 1 == end ? last : 1; }
};

Cover cover_of(const Axis& axis, int coarse) {
  const double from = std::max(0., axis.to_fine(coarse - 0.5) + 0.5);
  const double to = std::min(double(axis.cells), axis.to_fine(coarse + 0.5) + 0.5);
  constexpr double rounding = 1e-9;
  Cover c{int(std::floor(from + rounding)), int(std::ceil(to - rounding)), 1, 1};
  c.end = std::clamp(c.end, c.begin + 1, axis.cells);
  c.first = std::min(to, c.begin + 1.) - from;
  c.last = c.end - c.begin > 1 ? to - (c.end - 1) : c.first;
  return c;
}

/// What the mean of the fine heights over each known coarse cell misses; 0 at unknown ones.
Raster<float> missing_means(const Dem& dem, const Axes& axes, const Raster<float>& fine) {
  Raster<float> missing(dem.size());
  for (int row = 0; row < dem.size().rows; ++row)
    for (int col = 0; col < dem.size().cols; ++col) {
      if (!dem.known(col, row)) continue;
      const Cover x = cover_of(axes.x, col), y = cover_of(axes.y, row);
      double sum = 0, weights = 0;
      for (int v = y.begin; v < y.end; ++v)
        for (int u = x.begin; u < x.end; ++u) {
          const double w = x.weight(u) * y.weight(v);
          sum += w * double(fine(u, v));
          weights += w;
        }
      missing(col, row) = float(double(dem.z(col, row)) - sum / weights);
    }
  return missing;
}

void add_cubic(Raster<float>& fine, const Raster<float>& coarse, const Axes& axes) {
  for (int v = 0; v < fine.rows(); ++v)
    for (int u = 0; u < fine.cols(); ++u)
      fine(u, v) +=
          float(cubic_at(coarse, axes.x.origin + axes.x.step * u, axes.y.origin + axes.y.step * v));
}

void tell_misses(const Raster<float>& missing, std::size_t known, Supersampled& out) {
  double squares = 0;
  for (const float m : missing.cells()) {
    squares += double(m) * double(m);
    out.miss_max_m = std::max(out.miss_max_m, std::abs(double(m)));
  }
  out.miss_rms_m = std::sqrt(squares / double(known));
}

}  // namespace

std::vector<Field> fields(SupersampleOptions& o) {
  return {
      {"factor",
       o.factor,
       {1, 2147483646, true},
       "",
       "how many times finer the cells are: 2 halves the cell size"},
      {"preserve",
       o.preserve,
       {"heights", "block-mean"},
       "what is kept: the heights at the coarse cells' centres, or the mean of each coarse cell"},
      {"nodes", o.nodes,
       "the outer fine cells have the centres of the outer coarse ones; false: both lattices "
       "have the same outer edges"}};
}

Lattice finer_lattice(const Dem& dem, const SupersampleOptions& options) {
  const auto [x, y] = finer_axes(dem.size(), options);
  const auto& at = dem.ref.to_world;
  Lattice lattice{
      dem.ref, {x.cells, y.cells}, {dem.spacing.dx_m * x.step, dem.spacing.dy_m * y.step}};
  lattice.ref.to_world = {
      at[0] + at[1] * x.origin + at[2] * y.origin, at[1] * x.step, at[2] * y.step,
      at[3] + at[4] * x.origin + at[5] * y.origin, at[4] * x.step, at[5] * y.step};
  return lattice;
}

Supersampled supersample(const Dem& dem, const ChosenMethod& method,
                         const SupersampleOptions& options, const Run& run) {
  check_fillable(dem);
  const Lattice lattice = finer_lattice(dem, options);
  const Axes axes = finer_axes(dem.size(), options);
  const Lattice in_cells{{}, lattice.size, lattice.spacing};
  Binned binned = bin_points(points_of(dem, axes), in_cells, {}, run.part(0, 0.1));
  binned.dem.ref = lattice.ref;
  Gridded gridded = fill_points(binned, method, {.passes = 2}, run.part(0.1, 0.9));
  Supersampled out{std::move(gridded.filled), gridded.misfit.rms_m, gridded.misfit.max_m};
  if (options.preserve == Preserve::heights) return out;

  constexpr int most_corrections = 100;
  constexpr float good_m = 1e-3F;
  Raster<float> missing = missing_means(dem, axes, out.filled.z);
  for (int i = 0; i < most_corrections; ++i) {
    run.report(0.9, "restoring block means");
    if (std::ranges::all_of(missing.cells(), [](float m) { return std::abs(m) <= good_m; })) break;
    add_cubic(out.filled.z, missing, axes);
    missing = missing_means(dem, axes, out.filled.z);
  }
  out.miss_max_m = 0;
  tell_misses(missing, count(dem.known), out);
  return out;
}

}  // namespace dem
