#include "dem/erosion.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "numeric/parallel.h"
#include "numeric/simd.h"

namespace dem {
using namespace numeric;
namespace {

// What is outside has NaN as height: above(NaN) is 0, so nothing flows there, nothing comes from
// there, and no loop asks.
constexpr double kOutside = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = 1e-300;  // keeps 0 / 0 out

/// max(0, x), and 0 for NaN. Written with bits, as a branch would keep loops from being vectorised.
[[gnu::always_inline]] inline double above(double x) {
  return std::bit_cast<double>(std::bit_cast<std::int64_t>(x) & -std::int64_t(x > 0.0));
}

/// The factors of one run.
struct Rates {
  double gx, gy, gd;        // 1 over the distance of neighbours, the nearest: 1
  double most, dig;         // share of a slope that may flow, and be dug or filled, in a step
  double K_c, K_d, K_s;     // sediment capacity, deposition, softness
  double slide;             // share of the excess over the talus that slides to each neighbour
  double tx, ty, td;        // talus, in metres of height
  double base_m;            // lowest height at the start
  double rain, rain_per_m;  // metres of water, when it rains
};

Rates make_rates(const ErosionOptions& o, Spacing s, double base_m) {
  const double diagonal = std::hypot(s.dx_m, s.dy_m), nearest = std::min(s.dx_m, s.dy_m);
  const double gx = nearest / s.dx_m, gy = nearest / s.dy_m, gd = nearest / diagonal;
  const double talus = std::tan(o.talus_deg * std::numbers::pi / 180);
  return {gx,
          gy,
          gd,
          0.25 / (2 * gx + 2 * gy + 4 * gd),
          0.125 / (2 * gx + 2 * gy + 4 * gd),
          o.K_c,
          o.K_d,
          o.K_s,
          o.c_t / 16,
          talus * s.dx_m,
          talus * s.dy_m,
          talus * diagonal,
          base_m,
          o.rain_mm / 1000,
          o.rain_mm_per_km / 1e6};
}

// A row, and the rows above and below it. Every row has one cell outside at either end.
//     up[c - 1]   up[c]   up[c + 1]
//   here[c - 1] here[c] here[c + 1]
//   down[c - 1] down[c] down[c + 1]
struct Three {
  const double *up, *here, *down;
};
using In = const double* __restrict;
using Out = double* __restrict;

DEM_VECTORISED void rain_on(In a, const Rates& rates, int n, Out w) {
  const double rain = rates.rain, per_m = rates.rain_per_m, base = rates.base_m;
  for (int c = 0; c < n; ++c) w[c] += rain + per_m * above(a[c] - base);
}

DEM_VECTORISED void add_rows(In a, In w, int n, Out sum) {
  for (int c = 0; c < n; ++c) sum[c] = a[c] + w[c];
}

/// How far the surface lies above its lower neighbours, and below its higher ones, summed, each
/// over its distance.
DEM_VECTORISED void sum_slopes(In up, In here, In down, const Rates& r, int n, Out slope,
                               Out rise) {
  const double gx = r.gx, gy = r.gy, gd = r.gd;
  for (int c = 0; c < n; ++c) {
    const double h = here[c];
    rise[c] = gx * (above(here[c - 1] - h) + above(here[c + 1] - h)) +
              gy * (above(up[c] - h) + above(down[c] - h)) +
              gd * ((above(up[c - 1] - h) + above(up[c + 1] - h)) +
                    (above(down[c - 1] - h) + above(down[c + 1] - h)));
    slope[c] = gx * (above(h - here[c - 1]) + above(h - here[c + 1])) +
               gy * (above(h - up[c]) + above(h - down[c])) +
               gd * ((above(h - up[c - 1]) + above(h - up[c + 1])) +
                     (above(h - down[c - 1]) + above(h - down[c + 1])));
  }
}

/// What each cell keeps (kept_*) and what it gives: water and sediment per unit of slope.
DEM_VECTORISED void give(In slope_row, In rise_row, In a_row, In w_row, In s_row, const Rates& r,
                         int n, Out kept_a, Out kept_w, Out kept_s, Out water, Out sediment) {
  const double most = r.most, dig = r.dig, K_c = r.K_c, K_d = r.K_d, K_s = r.K_s;
  for (int c = 0; c < n; ++c) {
    const double slope = slope_row[c], w = w_row[c], s = s_row[c];
    const double f = std::min(w / (slope + kTiny), most);
    const double flow = f * slope;
    const double lack = K_c * flow - s;  // capacity not used, or (below 0) sediment too much
    const double dug = std::min(K_s * above(lack), dig * slope);
    const double rest = above(-lack);
    const double dropped = std::min(K_d * rest, w + dig * rise_row[c]);
    kept_a[c] = a_row[c] + (dropped - dug);
    kept_w[c] = above(w - flow);  // rounding may have taken more than there was
    kept_s[c] = rest - dropped;
    water[c] = f;
    sediment[c] = ((s - rest) + dug) / (slope + kTiny);
  }
}

/// Water and sediment that come down from the neighbours; wu is the water of the row above, sd the
/// sediment of the row below.
DEM_VECTORISED void take(In up, In here, In down, In wu, In wh, In wd, In su, In sh, In sd,
                         const Rates& r, int n, Out w, Out s) {
  const double gx = r.gx, gy = r.gy, gd = r.gd;
  for (int c = 0; c < n; ++c) {
    const double h = here[c];
    const double west = gx * above(here[c - 1] - h), east = gx * above(here[c + 1] - h);
    const double north = gy * above(up[c] - h), south = gy * above(down[c] - h);
    const double nw = gd * above(up[c - 1] - h), ne = gd * above(up[c + 1] - h);
    const double sw = gd * above(down[c - 1] - h), se = gd * above(down[c + 1] - h);
    w[c] += ((west * wh[c - 1] + east * wh[c + 1]) + (north * wu[c] + south * wd[c])) +
            ((nw * wu[c - 1] + ne * wu[c + 1]) + (sw * wd[c - 1] + se * wd[c + 1]));
    s[c] += ((west * sh[c - 1] + east * sh[c + 1]) + (north * su[c] + south * sd[c])) +
            ((nw * su[c - 1] + ne * su[c + 1]) + (sw * sd[c - 1] + se * sd[c + 1]));
  }
}

/// What comes down a difference of height beyond the talus, negative when it goes.
[[gnu::always_inline]] inline double excess(double difference, double talus) {
  return above(difference - talus) - above(-difference - talus);
}

DEM_VECTORISED void slide(In up, In here, In down, const Rates& r, int n, Out a) {
  const double tx = r.tx, ty = r.ty, td = r.td, share = r.slide;
  for (int c = 0; c < n; ++c) {
    const double b = here[c];
    const double sum = ((excess(here[c - 1] - b, tx) + excess(here[c + 1] - b, tx)) +
                        (excess(up[c] - b, ty) + excess(down[c] - b, ty))) +
                       ((excess(up[c - 1] - b, td) + excess(up[c + 1] - b, td)) +
                        (excess(down[c - 1] - b, td) + excess(down[c + 1] - b, td)));
    a[c] += share * sum;
  }
}

/// Rows of doubles with one cell of margin on every side.
class Grid {
 public:
  Grid(Size size, double margin)
      : stride_(std::size_t(size.cols) + 2),
        cells_(stride_ * (std::size_t(size.rows) + 2), margin) {}

  /// Row r from -1 to rows, at its column 0; column -1 and column cols are margin.
  double* row(int r) { return cells_.data() + std::size_t(r + 1) * stride_ + 1; }
  const double* row(int r) const { return cells_.data() + std::size_t(r + 1) * stride_ + 1; }

 private:
  std::size_t stride_;
  std::vector<double> cells_;
};

/// Terrain, water and sediment of one time.
struct State {
  Grid a, w, s;
  explicit State(Size size) : a(size, kOutside), w(size, 0), s(size, 0) {}
};

/// The rows that one thread holds between giving and taking: the last few of each kind, in a ring.
class Ring {
 public:
  explicit Ring(int cols, double margin) {
    for (auto& row : rows_) row.assign(std::size_t(cols) + 2, margin);
  }
  double* operator[](int r) { return rows_[std::size_t(r + 4) % rows_.size()].data() + 1; }
  Three around(int r) { return {(*this)[r - 1], (*this)[r], (*this)[r + 1]}; }

 private:
  std::array<std::vector<double>, 4> rows_;
};

struct Scratch {
  Ring surface, slope, rise, rained, a, w, s, water, sediment;
  explicit Scratch(int cols)
      : surface(cols, kOutside),
        slope(cols, 0),
        rise(cols, 0),
        rained(cols, 0),
        a(cols, kOutside),
        w(cols, 0),
        s(cols, 0),
        water(cols, 0),
        sediment(cols, 0) {}
};

/// One time step from `now` to `next`, a block of rows at a time.
class Step {
 public:
  Step(const ErosionOptions& o, const Rates& rates, Size size, bool rains)
      : o_(o), rates_(rates), size_(size), rains_(rains) {}

  /// Rows first to last - 1; `carried[r]` grows by the sediment that leaves row r.
  void block(const State& now, int first, int last, Scratch& t, State& next,
             std::vector<double>& carried) const {
    load(now, first - 2, t);
    load(now, first - 1, t);
    for (int r = first - 1; r <= last; ++r) {
      load(now, r + 1, t);
      give_row(now, r, t);
      if (r > first) take_row(now, r - 1, t, next, carried[std::size_t(r - 1)]);
    }
  }

 private:
  bool inside(int r) const { return r >= 0 && r < size_.rows; }

  /// Water with the rain in it, and the surface it has.
  void load(const State& now, int r, Scratch& t) const {
    const int n = size_.cols;
    if (!inside(r)) {
      std::fill_n(t.surface[r], n, kOutside);
      return;
    }
    std::copy_n(now.w.row(r), n, t.rained[r]);
    if (rains_) rain_on(now.a.row(r), rates_, n, t.rained[r]);
    add_rows(now.a.row(r), t.rained[r], n, t.surface[r]);
  }

  void give_row(const State& now, int r, Scratch& t) const {
    const int n = size_.cols;
    if (!inside(r)) {
      std::fill_n(t.water[r], n, 0.0);
      std::fill_n(t.sediment[r], n, 0.0);
      return;
    }
    const Three h = t.surface.around(r);
    sum_slopes(h.up, h.here, h.down, rates_, n, t.slope[r], t.rise[r]);
    give(t.slope[r], t.rise[r], now.a.row(r), t.rained[r], now.s.row(r), rates_, n, t.a[r], t.w[r],
         t.s[r], t.water[r], t.sediment[r]);
  }

  void take_row(const State& now, int r, Scratch& t, State& next, double& carried) const {
    const int n = size_.cols;
    const Three h = t.surface.around(r), w = t.water.around(r), s = t.sediment.around(r);
    take(h.up, h.here, h.down, w.up, w.here, w.down, s.up, s.here, s.down, rates_, n, t.w[r],
         t.s[r]);
    if (o_.c_t > 0) slide(now.a.row(r - 1), now.a.row(r), now.a.row(r + 1), rates_, n, t.a[r]);
    if (o_.open_border) drain(r, t.w[r], t.s[r], carried);
    std::copy_n(t.a[r], n, next.a.row(r));
    std::copy_n(t.w[r], n, next.w.row(r));
    std::copy_n(t.s[r], n, next.s.row(r));
  }

  /// Lets the rim's water and sediment leave.
  void drain(int r, double* w, double* s, double& carried) const {
    const bool whole = r == 0 || r == size_.rows - 1;
    for (int c = 0; c < size_.cols; c += whole ? 1 : std::max(1, size_.cols - 1)) {
      carried += s[c];
      w[c] = s[c] = 0;
    }
  }

  const ErosionOptions& o_;
  const Rates& rates_;
  Size size_;
  bool rains_;
};

void check_heights(const Dem& dem) {
  check_fillable(dem);
  const auto [dx, dy] = dem.spacing;
  if (!(std::isfinite(dx) && dx > 0 && std::isfinite(dy) && dy > 0))
    throw std::invalid_argument(
        fmt::format("spacing = {} x {} m; must be finite and above 0", dx, dy));
  for (int r = 0; r < dem.z.rows(); ++r)
    for (int c = 0; c < dem.z.cols(); ++c)
      if (dem.known(c, r) && !std::isfinite(dem.z(c, r)))
        throw std::invalid_argument(
            fmt::format("z({}, {}) = {}; must be finite where known", c, r, dem.z(c, r)));
}

State start_of(const Dem& dem) {
  State state(dem.size());
  for (int r = 0; r < dem.z.rows(); ++r)
    for (int c = 0; c < dem.z.cols(); ++c)
      state.a.row(r)[c] = dem.known(c, r) ? double(dem.z(c, r)) : kOutside;
  return state;
}

double lowest(const Dem& dem) {
  double low = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < dem.z.cells().size(); ++i)
    if (dem.known.cells()[i]) low = std::min(low, double(dem.z.cells()[i]));
  return low;
}

/// Sum of terrain and sediment over what is known.
double mass(const Dem& dem, const State& state) {
  double sum = 0;
  for (int r = 0; r < dem.z.rows(); ++r) {
    double row = 0;
    for (int c = 0; c < dem.z.cols(); ++c)
      if (dem.known(c, r)) row += state.a.row(r)[c] + state.s.row(r)[c];
    sum += row;
  }
  return sum;
}

/// Heights with the sediment settled, and the water on them.
ErosionFrame frame_of(const Dem& dem, const State& state, int step) {
  ErosionFrame frame{step, dem.z, Raster<float>(dem.size())};
  for (int r = 0; r < dem.z.rows(); ++r)
    for (int c = 0; c < dem.z.cols(); ++c) {
      if (!dem.known(c, r)) continue;
      frame.z(c, r) = float(state.a.row(r)[c] + state.s.row(r)[c]);
      frame.water_m(c, r) = float(state.w.row(r)[c]);
    }
  return frame;
}

}  // namespace

std::vector<Field> fields(ErosionOptions& o) {
  return {{"steps", o.steps, {0, 1000000}, "", "time steps"},
          {"rain_mm", o.rain_mm, {0, 1e6}, "mm", "water of one rainfall, everywhere"},
          {"rain_mm_per_km",
           o.rain_mm_per_km,
           {0, 1e6},
           "mm/km",
           "more of it for each kilometre above the lowest cell"},
          {"rain_every", o.rain_every, {1, 1000000}, "", "steps from one rainfall to the next"},
          {"K_c", o.K_c, {0, 1000}, "", "sediment that flowing water can carry, by volume"},
          {"K_d", o.K_d, {0, 1}, "", "share of the sediment beyond that which settles in a step"},
          {"K_s", o.K_s, {0, 1}, "", "softness: share of the missing sediment that water takes up"},
          {"talus_deg", o.talus_deg, {0, 89}, "deg", "slope that loose rock rests on"},
          {"c_t", o.c_t, {0, 1}, "", "how fast steeper slopes slide; 0: not at all"},
          {"open_border", o.open_border, "water and sediment leave over the rim"}};
}

Eroded erode(const Dem& dem, const ErosionOptions& options, const Run& run,
             const ErosionFrames& frames) {
  check_heights(dem);
  check_options(options);
  const Size size = dem.size();
  const Rates rates = make_rates(options, dem.spacing, lowest(dem));
  State now = start_of(dem), next(size);
  const double before = mass(dem, now);

  constexpr int kBlock = 64;
  const int blocks = (size.rows + kBlock - 1) / kBlock;
  std::vector<double> carried(std::size_t(size.rows), 0.0);
  with_threads(run.threads, [&] {
    tbb::enumerable_thread_specific<Scratch> scratch([&] { return Scratch(size.cols); });
    for (int step = 0; step < options.steps; ++step) {
      run.report(double(step) / options.steps, "erosion");
      const Step work(options, rates, size, step % options.rain_every == 0);
      parallel_for(0, blocks, 1, [&](int b) {
        work.block(now, b * kBlock, std::min(size.rows, (b + 1) * kBlock), scratch.local(), next,
                   carried);
      });
      std::swap(now, next);
      if (frames.every > 0 && frames.take && (step + 1) % frames.every == 0)
        frames.take(frame_of(dem, now, step + 1));
    }
  });

  const double area = dem.spacing.dx_m * dem.spacing.dy_m;
  double gone = 0;
  for (const double row : carried) gone += row;
  ErosionFrame end = frame_of(dem, now, options.steps);
  return {std::move(end.z), std::move(end.water_m), before * area, mass(dem, now) * area,
          gone * area};
}

}  // namespace dem
