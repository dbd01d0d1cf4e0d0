#include "fill/fill_layers.h"

#include <algorithm>
#include <cmath>

namespace dem::app {

/// Of d = z - aux on the slopes of z: a shift (u, v) of the aux shows as d = c + u zx + v zy.
struct FillLayers::Sums {
  double n = 0, x = 0, y = 0, d = 0, xx = 0, xy = 0, yy = 0, xd = 0, yd = 0;
  std::vector<float> offsets;  // a sample

  void add(double zx, double zy, double offset) {
    n += 1, x += zx, y += zy, d += offset;
    xx += zx * zx, xy += zx * zy, yy += zy * zy, xd += zx * offset, yd += zy * offset;
    if (offsets.size() < 1000000) offsets.push_back(float(offset));
  }
};

FillLayers::~FillLayers() = default;

FillLayers::FillLayers(const std::vector<std::string>& aux, const std::string& water,
                       const GeoRef& ref)
    : paths_(aux), sums_(aux.size()) {
  for (const std::string& path : aux) aux_.emplace_back(path, ref);
  if (!water.empty()) water_ = std::make_unique<Polygons>(water, ref);
}

void FillLayers::add(WindowData& data, const Box& box) {
  if (water_) data.water = water_->cells_in(box);
  const Dem& dem = data.dem;
  for (std::size_t k = 0; k < aux_.size(); ++k) {
    const Dem& guide = data.guides.emplace_back(aux_[k].read(box));
    for (int row = 1; row + 1 < box.rows; ++row)
      for (int col = 1; col + 1 < box.cols; ++col) {
        if (!guide.known(col, row) || !dem.known(col, row) || !dem.known(col - 1, row) ||
            !dem.known(col + 1, row) || !dem.known(col, row - 1) || !dem.known(col, row + 1))
          continue;
        sums_[k].add((double(dem.z(col + 1, row)) - double(dem.z(col - 1, row))) / 2,
                     (double(dem.z(col, row + 1)) - double(dem.z(col, row - 1))) / 2,
                     double(dem.z(col, row)) - double(guide.z(col, row)));
      }
  }
}

std::vector<FillLayers::Fit> FillLayers::fits() const {
  std::vector<Fit> fits;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    const Sums& s = sums_[k];
    Fit fit{paths_[k], std::size_t(s.n), 0, 0, 0, ""};
    if (s.n < 10) {
      fit.warning = "does not cover the surroundings of any hole; not used";
      fits.push_back(fit);
      continue;
    }
    std::vector<float> offsets = s.offsets;
    const auto middle = offsets.begin() + std::ptrdiff_t(offsets.size() / 2);
    std::ranges::nth_element(offsets, middle);
    fit.offset_m = double(*middle);
    const double xx = s.xx - s.x * s.x / s.n, xy = s.xy - s.x * s.y / s.n;
    const double yy = s.yy - s.y * s.y / s.n;
    const double xd = s.xd - s.x * s.d / s.n, yd = s.yd - s.y * s.d / s.n;
    const double determinant = xx * yy - xy * xy;
    if (determinant > 1e-6 * (xx + yy) * (xx + yy)) {
      fit.shift_cols = (yy * xd - xy * yd) / determinant;
      fit.shift_rows = (xx * yd - xy * xd) / determinant;
    }
    const auto half = [](double shift) { return std::abs(std::abs(shift) - 0.5) < 0.15; };
    if (std::abs(fit.offset_m) > 8)
      fit.warning = fmt::format(
          "lies {:.1f} m {} the raster in the median: another vertical datum (geoid, ellipsoid)? "
          "The offset is removed hole by hole",
          std::abs(fit.offset_m), fit.offset_m > 0 ? "below" : "above");
    else if (half(fit.shift_cols) || half(fit.shift_rows))
      fit.warning = fmt::format(
          "seems shifted by {:.2f} columns, {:.2f} rows: half a cell is the sign of area against "
          "node registration",
          fit.shift_cols, fit.shift_rows);
    fits.push_back(fit);
  }
  return fits;
}

}  // namespace dem::app
