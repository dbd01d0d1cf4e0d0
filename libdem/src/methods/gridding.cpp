#include "dem/gridding.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

std::vector<Field> fields(GriddingOptions& o) {
  return {{"passes",
           o.passes,
           {0, 100},
           "",
           "number of correction passes that pull the surface to points off cell centres"}};
}

Gridded fill_points(const Binned& binned, const ChosenMethod& method,
                    const GriddingOptions& options, const Run& run) {
  check_options(options);
  if (method.method->fill_noisy && !binned.sigma.empty()) {
    Gridded out{method.method->fill_noisy(binned.dem, binned.sigma, method.settings, run), {}};
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
