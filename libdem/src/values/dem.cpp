#include "dem/dem.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace dem {

void check_shape(const Dem& dem) {
  const Size z = dem.z.size(), known = dem.known.size();
  if (z.cells() == 0)
    throw std::invalid_argument(
        fmt::format("dem has {} x {} cells; must be at least 1 x 1", z.cols, z.rows));
  if (z != known)
    throw std::invalid_argument(fmt::format("dem.known is {} x {}; must be {} x {} as dem.z",
                                            known.cols, known.rows, z.cols, z.rows));
  if (!dem.breaks.empty() && dem.breaks.size() != z)
    throw std::invalid_argument(
        fmt::format("dem.breaks is {} x {}; must be {} x {} as dem.z, or empty", dem.breaks.cols(),
                    dem.breaks.rows(), z.cols, z.rows));
}

void check_fillable(const Dem& dem) {
  check_shape(dem);
  if (std::ranges::none_of(dem.known.cells(), [](auto k) { return k != 0; }))
    throw std::invalid_argument("dem has no known cell; at least one is needed");
}

}  // namespace dem
