#include "dem/gridding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dem/spline.h"
#include "numeric/cubic.h"

namespace dem {
using namespace numeric;
namespace {

/// A pass corrects a height by at most so many times what the plane moved it by: where points
/// contradict each other, a surface through all of them would be worse than the points.
constexpr float most_times = 3;

double miss_of(const OffCentre& p, const Raster<float>& z) {
  return double(p.z) - cubic_at(z, p.col + double(p.dx), p.row + double(p.dy));
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
