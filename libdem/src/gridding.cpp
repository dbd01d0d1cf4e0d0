#include "dem/gridding.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "dem/spline.h"

namespace dem {
namespace {

/// Weights of four cells in a row, for a place t (0 to 1) between the middle two: cubic convolution
/// that is exact on quadratics.
std::array<double, 4> cubic(double t) {
  return {((2 - t) * t - 1) * t / 2, ((3 * t - 5) * t * t + 2) / 2, ((4 - 3 * t) * t + 1) * t / 2,
          (t - 1) * t * t / 2};
}

/// The surface at a place between cells. Beyond the rim it goes on straight.
double surface_at(const Raster<float>& z, double col, double row) {
  const double c0 = std::floor(col), r0 = std::floor(row);
  const auto wx = cubic(col - c0), wy = cubic(row - r0);
  // The height of a cell, also just beyond the rim.
  const auto at = [&](int x, int y) {
    const int cx = std::clamp(x, 0, z.cols() - 1), cy = std::clamp(y, 0, z.rows() - 1);
    const int ix = std::clamp(2 * cx - x, 0, z.cols() - 1);
    const int iy = std::clamp(2 * cy - y, 0, z.rows() - 1);
    return 2 * double(z(cx, cy)) - double(z(ix, iy));
  };
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += wx[std::size_t(i)] * wy[std::size_t(j)] * at(int(c0) + i - 1, int(r0) + j - 1);
  return sum;
}

/// A pass corrects a height by at most so many times what the plane moved it by: where points
/// contradict each other, a surface through all of them would be worse than the points.
constexpr float most_times = 3;

double miss_of(const OffCentre& p, const Raster<float>& z) {
  return double(p.z) - surface_at(z, p.col + double(p.dx), p.row + double(p.dy));
}

Misfit misfit_of(const std::vector<OffCentre>& points, const Raster<float>& z) {
  Misfit m;
  double squares = 0;
  for (const OffCentre& p : points) {
    const double miss = std::abs(miss_of(p, z));
    squares += miss * miss;
    m.max_m = std::max(m.max_m, miss);
    ++m.points;
  }
  if (m.points > 0) m.rms_m = std::sqrt(squares / double(m.points));
  return m;
}

double figure(const Filled& filled, std::string_view name) {
  const auto found = std::ranges::find(filled.report, name, &Figure::name);
  return found == filled.report.end() ? 0 : found->value;
}

/// The spline with each cell's own noise.
Filled fill_noisy(const Binned& b, const Settings& settings, const Run& run) {
  SplineOptions options;
  apply(settings, fields(options));
  SplineOptions first = options;
  first.sigma = SplineSigma::law;
  const double scale = figure(fill_spline(b.dem, first, run.part(0, 0.5)), "scale");
  if (!(scale > 0))
    return fill_spline(b.dem, options, run.part(0.5, 1));  // a plane: nothing to weigh
  Raster<float> noise(b.dem.size());
  for (std::size_t i = 0; i < noise.cells().size(); ++i) {
    const double sigma = double(b.sigma.cells()[i]);
    noise.cells()[i] = float(sigma * sigma / (scale * scale));
  }
  options.nugget = 1;
  options.smooth_known = true;
  return fill_spline(b.dem, noise, options, run.part(0.5, 1));
}

}  // namespace

Gridded fill_points(const Binned& binned, const ChosenMethod& method,
                    const GriddingOptions& options, const Run& run) {
  if (options.passes < 0 || options.passes > 100)
    throw std::invalid_argument(fmt::format("passes = {}; must be in [0, 100]", options.passes));
  if (method.method->name == "spline" && !binned.sigma.empty()) {
    Gridded out{fill_noisy(binned, method.settings, run), {}};
    out.misfit = misfit_of(binned.off_centre, out.filled.z);
    return out;
  }
  const int passes = binned.off_centre.empty() ? 0 : options.passes;
  Dem dem = binned.dem;
  Gridded out;
  for (int pass = 0;; ++pass) {
    out.filled = method.method->fill(dem, method.settings,
                                     run.part(pass / (passes + 1.), (pass + 1.) / (passes + 1.)));
    if (pass == passes) break;
    for (const OffCentre& p : binned.off_centre) {
      const float most = most_times * std::abs(binned.dem.z(p.col, p.row) - p.z);
      dem.z(p.col, p.row) += std::clamp(float(miss_of(p, out.filled.z)), -most, most);
    }
  }
  out.misfit = misfit_of(binned.off_centre, out.filled.z);
  return out;
}

}  // namespace dem
