// Heights between the rivers of RiverLand [teoh2009, section 5].

#include <algorithm>
#include <cmath>
#include <utility>

#include "synthesis/flood.h"
#include "synthesis/riverland_parts.h"

namespace dem::synthesis {
using namespace numeric;
namespace {

constexpr std::uint64_t stream_slopes = 0x4e1a0003;
constexpr int slope_patch_cells = 48;  // coasts and rivers keep a slope for about that long

std::size_t bucket_count(Size size) { return std::max<std::size_t>(64, size.cells() / 64); }

/// Calls each(col, row, step length) for the neighbours of a cell that are land.
template <class Each>
void for_land_around(const Country& country, int col, int row, Each each) {
  const double side = country.cell.dx_m, up = country.cell.dy_m, diagonal = country.step_m(1, 1);
  for (int dr = -1; dr <= 1; ++dr)
    for (int dc = -1; dc <= 1; ++dc) {
      const Cell c{col + dc, row + dr};
      if ((dr == 0 && dc == 0) || !country.contains(c) || !country.is_land(c)) continue;
      each(c.col, c.row, float(dr == 0 ? side : dc == 0 ? up : diagonal));
    }
}

/// The slope parameter of the bank at a cell.
float bank_slope(int col, int row, const RiverLandOptions& o) {
  const double u = signed_uniform(
      random_bits(o.seed, stream_slopes, col / slope_patch_cells, row / slope_patch_cells));
  return float(o.slope * (1 + o.slope_variation * u));
}

/// The ideal heights of the maximal cells, those that no way leads through, smoothed; far_away
/// elsewhere.
Raster<float> maximal_heights(const Country& country, const Valleys& v, int smoothing) {
  Raster<float> top(country.size(), far_away);
  Mask passed(country.size());
  for (std::int32_t i : v.order) passed.cells()[std::size_t(v.toward.cells()[std::size_t(i)])] = 1;
  std::vector<std::int32_t> maximal;
  for (std::int32_t i : v.order) {
    const auto n = std::size_t(i);
    if (passed.cells()[n] || v.rise.cells()[n] == 0) continue;
    maximal.push_back(i);
    top.cells()[n] = v.foot.cells()[n] + v.rise.cells()[n];
  }
  std::vector<float> smoothed(maximal.size());
  const int cols = country.size().cols;
  for (int pass = 0; pass < smoothing; ++pass) {
    for (std::size_t m = 0; m < maximal.size(); ++m) {
      const int col = maximal[m] % cols, row = maximal[m] / cols;
      float sum = top(col, row), n = 1;
      for_land_around(country, col, row, [&](int c, int r, float) {
        if (top(c, r) != far_away) sum += top(c, r), n += 1;
      });
      smoothed[m] = std::max(sum / n, v.foot(col, row));
    }
    for (std::size_t m = 0; m < maximal.size(); ++m)
      top.cells()[std::size_t(maximal[m])] = smoothed[m];
  }
  return top;
}

/// Running means along rows and columns, twice each: ways side by side shall not differ much.
void smooth(Raster<float>& z) {
  constexpr int radius = 3;
  std::vector<float> line;
  const auto pass = [&](float* at, int n, std::ptrdiff_t stride) {
    for (int i = 0; i < n; ++i) line[std::size_t(i)] = at[i * stride];
    const auto value = [&](int i) { return line[std::size_t(std::clamp(i, 0, n - 1))]; };
    float sum = 0;
    for (int i = -radius; i <= radius; ++i) sum += value(i);
    for (int i = 0; i < n; ++i) {
      at[i * stride] = sum / (2 * radius + 1);
      sum += value(i + radius + 1) - value(i - radius);
    }
  };
  line.resize(std::size_t(std::max(z.cols(), z.rows())));
  for (int times = 0; times < 2; ++times) {
    for (int row = 0; row < z.rows(); ++row) pass(&z(0, row), z.cols(), 1);
    for (int col = 0; col < z.cols(); ++col) pass(&z(col, 0), z.rows(), z.cols());
  }
}

/// Raises land below cliffs until no step is steeper than cliff_slope, but for those at rivers.
void remove_cliffs(const Country& country, const Water& water, Raster<float>& z, double cliff_slope,
                   const Run& run) {
  const auto c = float(cliff_slope);
  const auto [low, high] = std::ranges::minmax(z.cells());
  CellQueue queue(-high, -low, bucket_count(z.size()));  // highest first
  const auto may_rise = [&](int col, int row) {
    return !water.wet(col, row) && !country.coast(col, row);
  };
  const int cols = z.cols();
  for (int row = 0; row < z.rows(); ++row)
    for (int col = 0; col < cols; ++col) {
      if (!country.is_land({col, row})) continue;
      bool cliff = false;
      for_land_around(country, col, row, [&](int x, int y, float step) {
        cliff |= z(x, y) < z(col, row) - c * step && may_rise(x, y);
      });
      if (cliff) queue.push(-z(col, row), row * cols + col);
    }
  for (std::size_t n = 0; !queue.empty(); ++n) {
    if (n % 262144 == 0) run.report(double(n) / double(z.cells().size()), "cliffs");
    const auto [key, index] = queue.pop();
    const int col = index % cols, row = index / cols;
    if (-key < z(col, row)) continue;  // raised since
    for_land_around(country, col, row, [&](int x, int y, float step) {
      if (!may_rise(x, y) || z(x, y) >= z(col, row) - c * step) return;
      z(x, y) = z(col, row) - c * step;
      queue.push(-z(x, y), y * cols + x);
    });
  }
}

}  // namespace

Valleys find_valleys(const Country& country, const Water& water, const RiverLandOptions& o,
                     const Run& run) {
  const Size size = country.size();
  Valleys v{Raster<float>(size, far_away),
            Raster<float>(size),
            Raster<float>(size, 1),
            Raster<std::int32_t>(size, -1),
            {}};
  v.order.reserve(size.cells());

  // No way between neighbours rises by less than a bucket: cells of one bucket are final together,
  // in whatever order.
  const double least_step = std::min(country.cell.dx_m, country.cell.dy_m);
  const auto width = float(0.999 * o.slope * (1 - o.slope_variation) * least_step);
  struct Step {
    int dc, dr;
    float length;
  };
  const auto side = float(country.cell.dx_m), up = float(country.cell.dy_m),
             diagonal = float(country.step_m(1, 1));
  const Step steps[] = {{-1, 0, side},      {1, 0, side},      {0, -1, up},       {0, 1, up},
                        {-1, -1, diagonal}, {1, -1, diagonal}, {-1, 1, diagonal}, {1, 1, diagonal}};
  std::vector<std::vector<std::int32_t>> buckets;
  const auto push = [&](float rise, std::int32_t index) {
    const auto b = std::size_t(rise / width);
    if (b >= buckets.size()) buckets.resize(b + 1);
    buckets[b].push_back(index);
  };
  for (int row = 0; row < size.rows; ++row)
    for (int col = 0; col < size.cols; ++col) {
      const bool wet = water.wet(col, row) != 0;
      if (!country.is_land({col, row})) v.rise(col, row) = 0;  // no way leads there
      if (!wet && !country.coast(col, row)) continue;
      v.rise(col, row) = 0;
      v.foot(col, row) = wet ? water.level(col, row) : 0;
      v.slope(col, row) = bank_slope(col, row, o);
      v.toward(col, row) = row * size.cols + col;
      push(0, row * size.cols + col);
    }

  float* const rise = v.rise.cells().data();
  float* const foot = v.foot.cells().data();
  float* const slope = v.slope.cells().data();
  std::int32_t* const toward = v.toward.cells().data();
  Mask final(size);
  for (std::size_t b = 0; b < buckets.size(); ++b) {
    run.report(double(v.order.size()) / double(size.cells()), "valleys");
    const std::vector<std::int32_t> bucket = std::move(buckets[b]);
    for (std::int32_t i : bucket) {
      if (std::exchange(final.cells()[std::size_t(i)], 1)) continue;  // a shorter way was found
      v.order.push_back(i);
      foot[i] = foot[toward[i]];
      slope[i] = slope[toward[i]];
      const int col = i % size.cols, row = i / size.cols;
      for (const auto& [dc, dr, step] : steps) {
        if (col + dc < 0 || row + dr < 0 || col + dc >= size.cols || row + dr >= size.rows)
          continue;
        const std::int32_t n = i + dr * size.cols + dc;
        const float there = rise[i] + slope[i] * step;
        if (there >= rise[n]) continue;
        rise[n] = there;
        toward[n] = i;
        push(there, n);
      }
    }
  }
  for (std::size_t i = 0; i < v.rise.cells().size(); ++i)
    if (!country.painted.land.cells()[i]) v.rise.cells()[i] = far_away;
  return v;
}

double profile_factor(SlopeProfile profile, double x) {
  switch (profile) {
    case SlopeProfile::linear:
      break;
    case SlopeProfile::concave:
      return x / (x + 1);
    case SlopeProfile::convex:
      return 1 + 1 / (x + 1);
    case SlopeProfile::trough: {  // flat, steep, flat, and on as the linear one from x = 2
      const double t = std::min(1.0, x / 2);
      return t * (3 - 2 * t);
    }
    case SlopeProfile::cliffs:  // a plain, and a rise within a tenth
      return std::lerp(0.12, 1.0, std::clamp((x - 1) * 10, 0.0, 1.0));
    case SlopeProfile::terraces: {  // treads, and risers in the last fifth of each
      if (x == 0) return 0;
      const double step = std::floor(x);
      return (step + std::clamp((x - step) * 5 - 4, 0.05 * (x - step), 1.0)) / x;
    }
  }
  return 1;
}

Raster<float> raise_land(const Country& country, const Water& water, const Valleys& v,
                         const RiverLandOptions& o, const Run& run) {
  Raster<float> gradient = maximal_heights(country, v, o.smoothing);
  run.report(0.3, "maximal cells");

  // Along each way the height is foot + gradient * rise: linear from the maximal cell down. Where
  // ways meet, each counts by the maximal cells above it.
  for (std::size_t n = 0; n < gradient.cells().size(); ++n) {
    float& g = gradient.cells()[n];
    g = g == far_away ? 0 : (g - v.foot.cells()[n]) / v.rise.cells()[n];
  }
  Raster<float> ways(country.size());
  for (std::size_t k = v.order.size(); k-- > 0;) {
    const auto n = std::size_t(v.order[k]), m = std::size_t(v.toward.cells()[n]);
    float& count = ways.cells()[n];
    if (count > 0)
      gradient.cells()[n] /= count;
    else
      count = 1;
    if (m == n) continue;
    gradient.cells()[m] += count * gradient.cells()[n];
    ways.cells()[m] += count;
  }
  smooth(gradient);
  Raster<float> z(country.size());
  for (std::int32_t i : v.order) {
    const auto n = std::size_t(i);
    z.cells()[n] = v.foot.cells()[n] + gradient.cells()[n] * v.rise.cells()[n];
  }
  remove_cliffs(country, water, z, o.cliff_slope, run.part(0.5, 1));
  return z;
}

}  // namespace dem::synthesis
