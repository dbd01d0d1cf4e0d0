#include "methods/guide_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dem::methods {

void GuideSums::add(const Dem& dem, const Dem& guide) {
  for (int row = 1; row + 1 < dem.z.rows(); ++row)
    for (int col = 1; col + 1 < dem.z.cols(); ++col) {
      if (!guide.known(col, row) || !dem.known(col, row) || !dem.known(col - 1, row) ||
          !dem.known(col + 1, row) || !dem.known(col, row - 1) || !dem.known(col, row + 1))
        continue;
      const double zx = (double(dem.z(col + 1, row)) - double(dem.z(col - 1, row))) / 2;
      const double zy = (double(dem.z(col, row + 1)) - double(dem.z(col, row - 1))) / 2;
      const double offset = double(dem.z(col, row)) - double(guide.z(col, row));
      n_ += 1, x_ += zx, y_ += zy, d_ += offset;
      xx_ += zx * zx, xy_ += zx * zy, yy_ += zy * zy, xd_ += zx * offset, yd_ += zy * offset;
      if (offsets_.size() < 1000000) offsets_.push_back(float(offset));
    }
}

GuideFit GuideSums::fit(const std::string& name) const {
  GuideFit fit{name, std::size_t(n_), 0, 0, 0, ""};
  if (n_ < 10) {
    fit.warning = "does not cover the surroundings of any void; not used";
    return fit;
  }
  std::vector<float> offsets = offsets_;
  const auto middle = offsets.begin() + std::ptrdiff_t(offsets.size() / 2);
  std::ranges::nth_element(offsets, middle);
  fit.offset_m = double(*middle);
  const double xx = xx_ - x_ * x_ / n_, xy = xy_ - x_ * y_ / n_, yy = yy_ - y_ * y_ / n_;
  const double xd = xd_ - x_ * d_ / n_, yd = yd_ - y_ * d_ / n_;
  const double determinant = xx * yy - xy * xy;
  if (determinant > 1e-6 * (xx + yy) * (xx + yy)) {
    fit.shift_cols = (yy * xd - xy * yd) / determinant;
    fit.shift_rows = (xx * yd - xy * xd) / determinant;
  }
  const auto half = [](double shift) { return std::abs(std::abs(shift) - 0.5) < 0.15; };
  if (std::abs(fit.offset_m) > 8)
    fit.warning = fmt::format(
        "lies {:.1f} m {} the raster in the median: another vertical datum (geoid, ellipsoid)? "
        "The offset is removed void by void",
        std::abs(fit.offset_m), fit.offset_m > 0 ? "below" : "above");
  else if (half(fit.shift_cols) || half(fit.shift_rows))
    fit.warning = fmt::format(
        "seems shifted by {:.2f} columns, {:.2f} rows: half a cell is the sign of area against "
        "node registration",
        fit.shift_cols, fit.shift_rows);
  return fit;
}

}  // namespace dem::methods
