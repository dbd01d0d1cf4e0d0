#pragma once
// Distances to the nearest of some cells. Private to the library.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "dem/raster.h"

namespace dem::numeric {

/// Lower envelope of parabolas: replaces f(i) by the least f(j) + bend (i - j)^2. With squared
/// distances and bend = step^2 this is one line of an exact distance transform.
/// Method: [felzenszwalb2012].
class Envelope {
 public:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  void apply(std::vector<double>& f, double bend) {
    const int n = int(f.size());
    at_.resize(f.size());
    from_.resize(f.size() + 1);
    int k = -1;
    for (int q = 0; q < n; ++q) {
      if (f[std::size_t(q)] == infinite) continue;
      double s = -infinite;
      while (k >= 0) {
        const int p = at_[std::size_t(k)];
        s = ((f[std::size_t(q)] - f[std::size_t(p)]) / bend + double(q) * q - double(p) * p) /
            (2. * (q - p));
        if (s > from_[std::size_t(k)]) break;
        --k;
      }
      ++k;
      at_[std::size_t(k)] = q;
      from_[std::size_t(k)] = k == 0 ? -infinite : s;
    }
    if (k < 0) return;
    const int last = k;
    out_.resize(f.size());
    k = 0;
    for (int i = 0; i < n; ++i) {
      while (k < last && from_[std::size_t(k) + 1] < i) ++k;
      const int p = at_[std::size_t(k)];
      out_[std::size_t(i)] = f[std::size_t(p)] + bend * double(i - p) * double(i - p);
    }
    f.swap(out_);
  }

 private:
  std::vector<int> at_;
  std::vector<double> from_, out_;
};

/// Distances (chamfer 5-7-11, in fifths of a cell, at most 65535) of all cells to the nearest
/// known.
inline Raster<std::uint16_t> chamfer_distances(const Mask& known) {
  constexpr int far = 65535;
  const Size size = known.size();
  Raster<std::uint16_t> d(size);
  // Two sweeps; each cell looks at the half of its neighbours that the sweep has passed.
  constexpr struct {
    int dx, dy, length;
  } steps[] = {{-1, 0, 5},   {0, -1, 5},  {-1, -1, 7},  {1, -1, 7},
               {-2, -1, 11}, {2, -1, 11}, {-1, -2, 11}, {1, -2, 11}};
  const auto relax = [&](int x, int y, int sign) {
    int best = d(x, y);
    for (const auto& [dx, dy, length] : steps)
      if (d.contains(x + sign * dx, y + sign * dy))
        best = std::min(best, d(x + sign * dx, y + sign * dy) + length);
    d(x, y) = std::uint16_t(best);
  };
  for (int y = 0; y < size.rows; ++y)
    for (int x = 0; x < size.cols; ++x) {
      d(x, y) = known(x, y) ? 0 : std::uint16_t(far);
      if (d(x, y)) relax(x, y, 1);
    }
  for (int y = size.rows; y-- > 0;)
    for (int x = size.cols; x-- > 0;)
      if (d(x, y)) relax(x, y, -1);
  return d;
}

}  // namespace dem::numeric
