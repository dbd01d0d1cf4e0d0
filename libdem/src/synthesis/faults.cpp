#include "dem/faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include "numeric/parallel.h"
#include "numeric/random.h"
#include "numeric/simd.h"

namespace dem {
using namespace numeric;
namespace {

// ---- Random values, drawn one after another

double signed_unit(Sequence& random) { return signed_uniform(random.bits()); }
double unit(Sequence& random) { return 0.5 + 0.5 * signed_unit(random); }

/// A random direction, without a sine: a point of the unit ball, drawn onto its surface.
template <std::size_t N>
std::array<double, N> direction(Sequence& random) {
  for (;;) {
    std::array<double, N> p;
    double square = 0;
    for (double& x : p) x = signed_unit(random), square += x * x;
    if (square > 1 || square < 1e-6) continue;
    for (double& x : p) x /= std::sqrt(square);
    return p;
  }
}

/// A step of mean 0 and mean square 1.
double step(Sequence& random, StepLaw law) {
  const double u = signed_unit(random), v = 1 - unit(random);  // v in (0, 1]
  switch (law) {
    case StepLaw::equal:
      return u < 0 ? -1 : 1;
    case StepLaw::uniform:
      return u * std::numbers::sqrt3;
    case StepLaw::gaussian:
      return std::sqrt(-2 * std::log(v)) * std::cos(std::numbers::pi * u);
    case StepLaw::exponential:
      return (u < 0 ? 1 : -1) * std::log(v) / std::numbers::sqrt2;
  }
  return 0;
}

// ---- A row by differences

/// A row that takes steps and ramps of any length in constant time, and is summed once.
class RowSum {
 public:
  explicit RowSum(int cols)
      : cols_(cols), jump_(std::size_t(cols) + 2), bend_(std::size_t(cols) + 2) {}

  void add_everywhere(double height) { jump_[0] += height; }

  /// Adds to the columns from `first` on, which may lie outside.
  void add_from(double first, double height) { jump_[entry(first)] += height; }

  /// Adds max(0, column - start) * slope.
  void add_hinge(double start, double slope) {
    const std::size_t first = entry(start);
    jump_[first] += (double(first) - start) * slope;
    bend_[first + 1] += slope;
  }

  void sum(std::span<float> z) const {
    double height = 0, slope = 0;
    for (std::size_t c = 0; c < z.size(); ++c) {
      slope += bend_[c];
      height += slope + jump_[c];
      z[c] = float(height);
    }
  }

 private:
  /// The first column at or after `place`, or the one past the last.
  std::size_t entry(double place) const {
    return std::size_t(std::ceil(std::clamp(place, 0.0, double(cols_))));
  }

  int cols_;
  std::vector<double> jump_, bend_;
};

/// Makes every row, in parallel: `fill(row, its cells)`.
template <class Fill>
Raster<float> make_rows(Size size, const Run& run, Fill fill) {
  Raster<float> z(size);
  with_threads(run.threads, [&] {
    constexpr int kRowsAtOnce = 32;
    for (int first = 0; first < size.rows; first += kRowsAtOnce) {
      run.report(double(first) / size.rows, "displacements");
      parallel_for(first, std::min(size.rows, first + kRowsAtOnce), 1,
                   [&](int r) { fill(r, z.row(r)); });
    }
  });
  return z;
}

// ---- Straight faults

/// The ground rises from -height to height where nx x + ny y crosses `distance`; x and y are metres
/// from the canvas's centre.
struct Fault {
  double nx, ny, distance, height;
};

std::vector<Fault> random_faults(const FaultOptions& o, double reach_m) {
  Sequence random(o.seed, 11);
  std::vector<Fault> faults(static_cast<std::size_t>(o.count));
  for (Fault& f : faults) {
    const auto [nx, ny] = direction<2>(random);
    f = {nx, ny, signed_unit(random) * reach_m,
         step(random, o.steps) * o.relief_m / std::sqrt(double(o.count))};
  }
  return faults;
}

/// Adds one fault to the row at `y`, columns dx apart from x = `west` on.
void add_fault(const Fault& f, double y, double west, double dx, double width_m, RowSum& row) {
  const double across = f.nx * dx;                           // what one column adds
  const double start = f.nx * west + f.ny * y - f.distance;  // at column 0
  const double half = width_m / 2;
  if (std::abs(across) < 1e-9 * dx) {  // along the row: all of it is on one side
    row.add_everywhere(f.height * (half > 0    ? std::clamp(start / half, -1.0, 1.0)
                                   : start > 0 ? 1.0
                                               : -1.0));
    return;
  }
  const double to = across > 0 ? f.height : -f.height;  // height on the east side
  const double middle = -start / across, spread = half / std::abs(across);
  row.add_everywhere(-to);
  if (spread < 1e-6) {
    row.add_from(middle, 2 * to);
  } else {
    row.add_hinge(middle - spread, to / spread);
    row.add_hinge(middle + spread, -to / spread);
  }
}

// ---- Circles on the sphere

/// The cap n p > offset rises, the rest sinks; p is a point of the unit sphere.
struct Cap {
  double nx, ny, nz, offset, height;
  double longitude;  // of n, in degrees
};

std::vector<Cap> random_caps(const GlobeOptions& o) {
  Sequence random(o.seed, 12);
  std::vector<Cap> caps(static_cast<std::size_t>(o.count));
  for (Cap& c : caps) {
    const auto [nx, ny, nz] = direction<3>(random);
    const double offset = o.off_centre * signed_unit(random);
    c = {nx,
         ny,
         nz,
         offset,
         step(random, o.steps) * o.relief_m / std::sqrt(double(o.count)),
         std::atan2(ny, nx) * 180 / std::numbers::pi};
  }
  return caps;
}

/// Columns of a grid of longitudes.
struct Longitudes {
  double first, step;
  int cols;
};

/// Adds a cap to the row at a latitude: a span of longitudes around that of n, or all or nothing.
void add_cap(const Cap& c, double sin_lat, double cos_lat, const Longitudes& lon, RowSum& row) {
  const double flat = std::hypot(c.nx, c.ny) * cos_lat, upright = c.nz * sin_lat - c.offset;
  if (std::abs(upright) >= flat) {
    row.add_everywhere(upright > 0 ? c.height : -c.height);
    return;
  }
  row.add_everywhere(-c.height);
  const double half = std::acos(-upright / flat) * 180 / std::numbers::pi;
  // The span and its images one turn away: a window may show any of them.
  const double west = (c.longitude - half - lon.first) / lon.step;
  const double east = (c.longitude + half - lon.first) / lon.step;
  const double turn = 360 / std::abs(lon.step);
  const double low = std::min(west, east), high = std::max(west, east);
  for (double t = std::floor(-high / turn); low + t * turn < lon.cols; ++t) {
    row.add_from(low + t * turn, 2 * c.height);
    row.add_from(high + t * turn, -2 * c.height);
  }
}

/// Sine and cosine of a latitude in degrees; the cosine of a pole is 0.
std::pair<double, double> sine_cosine(double latitude) {
  const double sine = std::sin(latitude * std::numbers::pi / 180);
  const double cosine = std::abs(latitude) >= 90 ? 0 : std::cos(latitude * std::numbers::pi / 180);
  return {sine, cosine};
}

// ---- Collage

/// One shape: q(dx, dy) = a dx^2 + 2 b dx dy + c dy^2 is 1 on its rim (a rectangle: dx^2 a <= 1 and
/// dy^2 c <= 1).
struct Piece {
  double x, y, a, b, c, height;
};

/// A radius between the two with density r^-exponent, by inversion.
double random_radius(Sequence& random, const CollageOptions& o) {
  const double u = unit(random), p = 1 - o.size_exponent;
  if (std::abs(p) < 1e-9) return o.radius_min_m * std::pow(o.radius_max_m / o.radius_min_m, u);
  const double low = std::pow(o.radius_min_m / o.radius_max_m, p);
  return o.radius_max_m * std::pow(low + u * (1 - low), 1 / p);
}

double signed_height(double height, CollageSign sign) {
  if (sign == CollageSign::both) return height;
  return sign == CollageSign::up ? std::abs(height) : -std::abs(height);
}

std::vector<Piece> random_pieces(const CollageOptions& o, double width_m, double height_m) {
  Sequence random(o.seed, 13);
  std::vector<Piece> pieces(static_cast<std::size_t>(o.count));
  for (Piece& p : pieces) {
    const double r = random_radius(random, o);
    const double stretch = std::sqrt(1 + (o.aspect - 1) * unit(random));
    const auto [cos, sin] = direction<2>(random);
    const double u = 1 / (r * stretch * r * stretch), v = stretch * stretch / (r * r);
    p.x = signed_unit(random) * (width_m / 2 + o.radius_max_m);
    p.y = signed_unit(random) * (height_m / 2 + o.radius_max_m);
    p.height = signed_height(
        step(random, o.steps) * o.step_m * std::pow(r / o.radius_max_m, o.growth), o.sign);
    if (o.shape == CollageShape::rectangle)
      p.a = cos > 0 ? u : v, p.b = 0, p.c = cos > 0 ? v : u;
    else
      p.a = cos * cos * u + sin * sin * v, p.b = cos * sin * (u - v),
      p.c = sin * sin * u + cos * cos * v;
  }
  return pieces;
}

/// The x, from the piece's centre, between which a row at dy lies inside its rim; none: empty.
struct Span {
  double west = 1, east = 0;
};

Span span_of(const Piece& p, CollageShape shape, double dy) {
  if (shape == CollageShape::rectangle) {
    const double half = 1 / std::sqrt(p.a);
    return p.c * dy * dy <= 1 ? Span{-half, half} : Span{};
  }
  const double root = p.b * p.b * dy * dy - p.a * (p.c * dy * dy - 1);
  if (root < 0) return {};
  return {(-p.b * dy - std::sqrt(root)) / p.a, (-p.b * dy + std::sqrt(root)) / p.a};
}

/// q along a row: a x^2 + b x + c with x in columns from the row's start.
struct Quadratic {
  float a, b, c;
};

DEM_VECTORISED void add_crater(float height, Quadratic q, int cols, float* __restrict z) {
  for (int i = 0; i < cols; ++i) {
    const float x = float(i);
    z[i] += height / (1 + ((q.a * x + q.b) * x + q.c));
  }
}

/// Adds a cone or a hump between two columns.
void add_peak(const Piece& p, CollageShape shape, double dx0, double dx, double dy, int first,
              int last, std::span<float> z) {
  for (int i = first; i <= last; ++i) {
    const double x = dx0 + dx * i;
    const double q = std::clamp((p.a * x + 2 * p.b * dy) * x + p.c * dy * dy, 0.0, 1.0);
    const double share = shape == CollageShape::cone ? 1 - std::sqrt(q) : (1 - q) * (1 - q);
    z[std::size_t(i)] += float(p.height * share);
  }
}

/// Adds a piece to the row at y, whose columns are dx apart from x = `west` on.
void add_piece(const Piece& p, CollageShape shape, double y, double west, double dx,
               std::span<float> z, RowSum& row) {
  const double dy = y - p.y, dx0 = west - p.x;
  if (shape == CollageShape::crater) {
    add_crater(float(p.height),
               {float(p.a * dx * dx), float(2 * dx * (p.a * dx0 + p.b * dy)),
                float((p.a * dx0 + 2 * p.b * dy) * dx0 + p.c * dy * dy)},
               int(z.size()), z.data());
    return;
  }
  const Span span = span_of(p, shape, dy);
  const double n = double(z.size());
  const double first = std::ceil(std::clamp((span.west - dx0) / dx, 0.0, n));
  const double past = std::floor(std::clamp((span.east - dx0) / dx, -1.0, n - 1)) + 1;
  if (span.west > span.east || first >= past) return;
  if (shape == CollageShape::disc || shape == CollageShape::rectangle) {
    row.add_from(first, p.height);
    row.add_from(past, -p.height);
  } else {
    add_peak(p, shape, dx0, dx, dy, int(first), int(past) - 1, z);
  }
}

/// The place of row 0 or column 0, the middle of the canvas being 0.
double edge(int cells, double cell_m) { return -0.5 * (cells - 1) * cell_m; }

std::vector<std::string> step_laws() { return {"equal", "uniform", "gaussian", "exponential"}; }

}  // namespace

std::vector<Field> fields(FaultOptions& o) {
  return {{"count", o.count, {1, 1e7}, "", "faults"},
          {"relief_m", o.relief_m, {0, 1e6}, "m", "standard deviation that all steps add up to"},
          {"steps", o.steps, step_laws(), "how the steps are distributed"},
          {"width_m", o.width_m, {0, 1e9}, "m", "a fault rises over this distance; 0: at once"},
          {"seed", o.seed, "of random numbers"}};
}

std::vector<Field> fields(GlobeOptions& o) {
  return {{"count", o.count, {1, 1e7}, "", "faults"},
          {"relief_m", o.relief_m, {0, 1e6}, "m", "standard deviation that all steps add up to"},
          {"steps", o.steps, step_laws(), "how the steps are distributed"},
          {"off_centre",
           o.off_centre,
           {0, 1},
           "radii",
           "farthest the planes pass from the centre; 0: great circles"},
          {"seed", o.seed, "of random numbers"}};
}

std::vector<Field> fields(CollageOptions& o) {
  return {
      {"shape", o.shape, {"disc", "rectangle", "cone", "crater", "hump"}, "what is pasted"},
      {"count", o.count, {1, 1e7}, "", "how many, some of them outside the canvas"},
      {"radius_min_m", o.radius_min_m, {1e-3, 1e9}, "m", "smallest radius"},
      {"radius_max_m", o.radius_max_m, {1e-3, 1e9}, "m", "largest radius"},
      {"size_exponent", o.size_exponent, {-8, 8}, "", "radii have the density r^-size_exponent"},
      {"step_m", o.step_m, {0, 1e6}, "m", "height of the largest, root mean square"},
      {"growth", o.growth, {-2, 4}, "", "height goes with r^growth"},
      {"steps", o.steps, step_laws(), "how the heights are distributed"},
      {"sign", o.sign, {"both", "up", "down"}, "whether they are hills, holes or both"},
      {"aspect", o.aspect, {1, 100}, "", "largest squared ratio of length to width"},
      {"seed", o.seed, "of random numbers"}};
}

Raster<float> generate_faults(const Canvas& canvas, const FaultOptions& options, const Run& run) {
  check_canvas(canvas);
  check_options(options);
  const auto [dx, dy] = canvas.spacing;
  const double west = edge(canvas.size.cols, dx), north = edge(canvas.size.rows, dy);
  const auto faults = random_faults(options, std::max(std::hypot(west, north), dx + dy));
  return make_rows(canvas.size, run, [&, dx = dx, dy = dy](int r, std::span<float> z) {
    RowSum row(int(z.size()));
    for (const Fault& f : faults) add_fault(f, north + dy * r, west, dx, options.width_m, row);
    row.sum(z);
  });
}

Raster<float> generate_globe(const Canvas& canvas, const GlobeOptions& options, const Run& run) {
  check_canvas(canvas);
  check_options(options);
  const auto& at = canvas.ref.to_world;
  const double last = at[3] + at[5] * (canvas.size.rows - 1);
  for (const double latitude : {at[3], last})
    if (std::abs(latitude) > 90)
      throw std::invalid_argument(
          fmt::format("latitude = {}; rows must lie in [-90, 90] degrees", latitude));
  const Longitudes longitudes{at[0], at[1], canvas.size.cols};
  const auto caps = random_caps(options);
  return make_rows(canvas.size, run, [&](int r, std::span<float> z) {
    const auto [sine, cosine] = sine_cosine(at[3] + at[5] * r);
    RowSum row(int(z.size()));
    for (const Cap& cap : caps) add_cap(cap, sine, cosine, longitudes, row);
    row.sum(z);
  });
}

Raster<float> generate_collage(const Canvas& canvas, const CollageOptions& options,
                               const Run& run) {
  check_canvas(canvas);
  check_options(options);
  if (options.radius_min_m > options.radius_max_m)
    throw std::invalid_argument(fmt::format("radius_min_m = {}; must be at most radius_max_m = {}",
                                            options.radius_min_m, options.radius_max_m));
  const auto [dx, dy] = canvas.spacing;
  const double west = edge(canvas.size.cols, dx), north = edge(canvas.size.rows, dy);
  const auto pieces = random_pieces(options, -2 * west, -2 * north);
  return make_rows(canvas.size, run, [&, dx = dx, dy = dy](int r, std::span<float> z) {
    RowSum row(int(z.size()));
    std::vector<float> smooth(z.size());
    for (const Piece& p : pieces)
      add_piece(p, options.shape, north + dy * r, west, dx, smooth, row);
    row.sum(z);
    for (std::size_t c = 0; c < z.size(); ++c) z[c] += smooth[c];
  });
}

}  // namespace dem
