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

std::vector<Spacing> spacing_of_rows(const Dem& dem) {
  const auto rows = std::size_t(dem.z.rows());
  if (dem.row_spacing.empty()) return std::vector<Spacing>(rows, dem.spacing);
  if (dem.row_spacing.size() != rows)
    throw std::invalid_argument(fmt::format(
        "dem.row_spacing has {} values; must have {}, one a row", dem.row_spacing.size(), rows));
  return dem.row_spacing;
}

GeoRef crop(GeoRef ref, const Box& box) {
  auto& at = ref.to_world;
  at[0] += at[1] * box.col + at[2] * box.row;
  at[3] += at[4] * box.col + at[5] * box.row;
  return ref;
}

Dem crop(const Dem& dem, const Box& box, Spacing spacing) {
  Dem part{crop(dem.z, box), crop(dem.known, box), crop(dem.ref, box), spacing};
  if (!dem.breaks.empty()) part.breaks = crop(dem.breaks, box);
  const auto known = part.known.cells();
  const auto z = part.z.cells();
  for (std::size_t i = 0; i < z.size(); ++i)
    if (!known[i]) z[i] = 0;
  return part;
}

}  // namespace dem
