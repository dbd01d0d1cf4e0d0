#include "synthesis/paths.h"

#include <fmt/format.h>

#include <stdexcept>

namespace dem::synthesis {

void check_map(Size size, Spacing spacing, int least, std::string_view what) {
  constexpr std::size_t most = std::size_t{1} << 28;
  if (std::min(size.cols, size.rows) < least)
    throw std::invalid_argument(fmt::format("size = {} x {}; must be at least {} x {} cells for {}",
                                            size.cols, size.rows, least, least, what));
  if (size.cells() > most)
    throw std::invalid_argument(fmt::format("size = {} x {}; must be at most {} cells for {}",
                                            size.cols, size.rows, most, what));
  for (double d : {spacing.dx_m, spacing.dy_m})
    if (!(d > 0 && std::isfinite(d)))
      throw std::invalid_argument(
          fmt::format("spacing = {} x {} m; must be above 0", spacing.dx_m, spacing.dy_m));
}

}  // namespace dem::synthesis
