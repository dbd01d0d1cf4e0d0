#include "dem/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "numeric/parallel.h"
#include "numeric/random.h"
#include "numeric/simd.h"

namespace dem {
using namespace numeric;
namespace {

// ---- Gradient noise

/// Brings the standard deviation to 1/3: without it, the mean square over a cell is 1/3 (that of a
/// gradient's component) times the integral of sum w^2 (dx^2 + dy^2) over the four corners: 0.0310.
constexpr float kUnit = 1.8925723f;

/// Two signed 16-bit numbers of a lattice point's hash: its gradient times 32767.5.
[[gnu::always_inline]] inline std::uint32_t scramble(std::uint32_t h) {
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  h ^= h >> 12;
  h *= 0x297a2d39u;
  return h ^ (h >> 15);
}

constexpr std::uint32_t kColumn = 0x9e3779b1u, kRow = 0x85ebca77u;

/// The plane through a lattice point, 0 there, at (dx, dy) from it.
[[gnu::always_inline]] inline float plane(std::uint32_t point, float dx, float dy) {
  constexpr float scale = kUnit / 32767.5f;
  const std::uint32_t h = scramble(point);
  const float gx = float(std::int32_t(h & 0xffffu)) * scale - kUnit;
  const float gy = float(std::int32_t(h >> 16)) * scale - kUnit;
  return gx * dx + gy * dy;
}

[[gnu::always_inline]] inline float fade(float t) {
  return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

/// Noise at (u, v) in the lattice cell (col, row), u and v in [0, 1).
[[gnu::always_inline]] inline float noise_in_cell(std::int32_t col, float u, std::int32_t row,
                                                  float v, std::uint32_t key) {
  const std::uint32_t point = (std::uint32_t(col) * kColumn + std::uint32_t(row) * kRow) ^ key;
  const std::uint32_t right =
      (std::uint32_t(col) * kColumn + kColumn + std::uint32_t(row) * kRow) ^ key;
  const std::uint32_t up = (std::uint32_t(col) * kColumn + std::uint32_t(row) * kRow + kRow) ^ key;
  const std::uint32_t both =
      (std::uint32_t(col) * kColumn + kColumn + std::uint32_t(row) * kRow + kRow) ^ key;
  const float s = fade(u), t = fade(v);
  const float a = plane(point, u, v), b = plane(right, u - 1, v);
  const float c = plane(up, u, v - 1), d = plane(both, u - 1, v - 1);
  const float low = a + s * (b - a), high = c + s * (d - c);
  return low + t * (high - low);
}

/// A coordinate as lattice cell and place in it.
[[gnu::always_inline]] inline void split(double x, std::int32_t& cell, float& place) {
  const double whole = std::floor(x);
  cell = std::int32_t(whole);
  place = float(x - whole);
}

/// Lattice cells and places in them of a row's columns.
struct Places {
  std::vector<std::int32_t> cell;
  std::vector<float> place;
  explicit Places(std::size_t n) : cell(n), place(n) {}
};

DEM_VECTORISED void split_all(const double* x_m, double frequency, double shift, std::size_t n,
                              std::int32_t* cell, float* place) {
  for (std::size_t i = 0; i < n; ++i) split(x_m[i] * frequency + shift, cell[i], place[i]);
}

/// Noise along a straight row.
DEM_VECTORISED void noise_along(const std::int32_t* cell, const float* place, std::int32_t row,
                                float v, std::uint32_t key, std::size_t n,
                                float* __restrict noise) {
  for (std::size_t i = 0; i < n; ++i) noise[i] = noise_in_cell(cell[i], place[i], row, v, key);
}

/// Noise at scattered places.
DEM_VECTORISED void noise_at(const std::int32_t* col, const float* u, const std::int32_t* row,
                             const float* v, std::uint32_t key, std::size_t n,
                             float* __restrict noise) {
  for (std::size_t i = 0; i < n; ++i) noise[i] = noise_in_cell(col[i], u[i], row[i], v[i], key);
}

// ---- Octaves

/// One wavelength of the sum.
struct Octave {
  std::uint32_t key = 0;
  double frequency = 0;  // lattice cells per metre
  double shift_x = 0, shift_y = 0;
};

/// Uses of one seed.
enum Stream : std::uint64_t { kTerrain = 1, kBend = 2, kWarp = 3 };

double unit_interval(std::uint64_t bits) { return 0.5 + 0.5 * signed_uniform(bits); }

Octave make_octave(std::uint64_t seed, Stream stream, int i, double frequency) {
  return {std::uint32_t(random_bits(seed, stream, i, 0)), frequency,
          unit_interval(random_bits(seed, stream, i, 1)),
          unit_interval(random_bits(seed, stream, i, 2))};
}

std::vector<Octave> make_octaves(std::uint64_t seed, Stream stream, int count, double wavelength_m,
                                 double lacunarity) {
  std::vector<Octave> octaves;
  for (int i = 0; i < count; ++i)
    octaves.push_back(make_octave(seed, stream, i, std::pow(lacunarity, i) / wavelength_m));
  return octaves;
}

/// Octaves of the 1/f^3 noise that bends ridges and valleys.
constexpr int kBendOctaves = 6;

/// The part of the world that laws by position run over.
struct Patch {
  double west_m = 0, south_m = 0, side_m = 0;
};

bool goes_by_position(const NoiseOptions& o) {
  return o.shape != NoiseShape::plain || o.H_law != HLaw::constant;
}

// ---- Laws, a row at a time

DEM_VECTORISED void add_fbm(const float* noise, const float* weight, const float* shape, float c_t,
                            float c_s, std::size_t n, float* __restrict a) {
  for (std::size_t i = 0; i < n; ++i) a[i] += shape[i] * ((noise[i] + c_t) * c_s) * weight[i];
}

DEM_VECTORISED void add_heterogeneous(const float* noise, const float* weight, float c_t, float c_s,
                                      std::size_t n, float* __restrict a) {
  for (std::size_t i = 0; i < n; ++i) a[i] += a[i] * ((noise[i] + c_t) * c_s) * weight[i];
}

DEM_VECTORISED void add_hybrid(const float* noise, const float* weight, float c_t, float c_s,
                               std::size_t n, float* __restrict a, float* __restrict rough) {
  for (std::size_t i = 0; i < n; ++i) {
    const float term = (noise[i] + c_t) * c_s * weight[i];
    const float r = std::min(rough[i], 1.0f);
    a[i] += r * term;
    rough[i] = r * term;
  }
}

DEM_VECTORISED void add_ridged(const float* noise, const float* weight, float c_t, float c_s,
                               float gain, std::size_t n, float* __restrict a,
                               float* __restrict rough) {
  for (std::size_t i = 0; i < n; ++i) {
    const float edge = c_t - std::abs(noise[i]);
    const float term = rough[i] * (edge * edge);
    a[i] += term * c_s * weight[i];
    rough[i] = std::clamp(term * gain, 0.0f, 1.0f);
  }
}

/// Everything about a terrain that does not change from row to row, for given columns.
class Terrain {
 public:
  Terrain(const NoiseOptions& o, std::vector<double> east_m, Patch patch)
      : o_(o),
        patch_(patch),
        east_m_(std::move(east_m)),
        octaves_(make_octaves(o.seed, kTerrain, o.octaves, o.wavelength_m, o.lacunarity)),
        bends_(make_octaves(o.seed, kBend, o.bend > 0 ? kBendOctaves : 0, o.wavelength_m, 2)) {
    for (const Octave& octave : octaves_) columns_.push_back(places(octave));
    for (const Octave& octave : bends_) bend_columns_.push_back(places(octave));
    for (int i = 0; i < o.octaves; ++i) weights_.push_back(weights(i));
  }

  /// The heights of one row, in metres.
  void row(double north_m, std::span<float> z) const {
    const std::size_t n = east_m_.size();
    const float c_t = float(o_.c_t), c_s = float(o_.c_s);
    const std::vector<float> shape = shape_row(north_m);
    const Warped warped = warp_row(north_m);
    std::vector<float> noise(n), rough(n, 1.0f);
    std::ranges::fill(z, 0.0f);
    for (std::size_t i = 0; i < octaves_.size(); ++i) {
      if (o_.warp > 0)
        noise_of(octaves_[i], warped, noise);
      else
        noise_of(octaves_[i], columns_[i], north_m, noise);
      const float* w = weights_[i].data();
      if (o_.law == NoiseLaw::ridged)
        add_ridged(noise.data(), w, c_t, c_s, float(o_.gain), n, z.data(), rough.data());
      else if (o_.law == NoiseLaw::fbm)
        add_fbm(noise.data(), w, shape.data(), c_t, c_s, n, z.data());
      else if (i == 0)
        add_fbm(noise.data(), w, shape.data(), c_t, c_s, n, z.data());
      else if (o_.law == NoiseLaw::heterogeneous)
        add_heterogeneous(noise.data(), w, c_t, c_s, n, z.data());
      else
        add_hybrid(noise.data(), w, c_t, c_s, n, z.data(), rough.data());
      if (i == 0) begin(north_m, shape, z, rough);
    }
    const float relief = float(o_.relief_m);
    for (float& height : z) height *= relief;
  }

 private:
  /// Displaced places of a row.
  struct Warped {
    std::vector<double> east_m, north_m;
  };

  /// Lattice cells of one octave's columns.
  Places places(const Octave& octave) const {
    Places p(east_m_.size());
    split_all(east_m_.data(), octave.frequency, octave.shift_x, east_m_.size(), p.cell.data(),
              p.place.data());
    return p;
  }

  /// From the patch's west (0) to its east (1).
  double x_of(double east_m) const { return (east_m - patch_.west_m) / patch_.side_m; }

  double H_at(double east_m) const {
    if (o_.H_law == HLaw::constant) return o_.H;
    const double x = std::clamp(x_of(east_m), 0.0, 1.0);
    if (o_.H_law == HLaw::linear) return o_.H + x * (o_.H_east - o_.H);
    return 1 / std::max(x, 1e-3) - 1.5;
  }

  /// The weight of octave i in every column.
  std::vector<float> weights(int i) const {
    std::vector<float> w(east_m_.size());
    for (std::size_t c = 0; c < w.size(); ++c)
      w[c] = float(std::pow(o_.lacunarity, -H_at(east_m_[c]) * i));
    return w;
  }

  void noise_of(const Octave& octave, const Places& columns, double north_m,
                std::vector<float>& noise) const {
    std::int32_t row = 0;
    float v = 0;
    split(north_m * octave.frequency + octave.shift_y, row, v);
    noise_along(columns.cell.data(), columns.place.data(), row, v, octave.key, noise.size(),
                noise.data());
  }

  void noise_of(const Octave& octave, const Warped& at, std::vector<float>& noise) const {
    const std::size_t n = noise.size();
    Places cols(n), rows(n);
    split_all(at.east_m.data(), octave.frequency, octave.shift_x, n, cols.cell.data(),
              cols.place.data());
    split_all(at.north_m.data(), octave.frequency, octave.shift_y, n, rows.cell.data(),
              rows.place.data());
    noise_at(cols.cell.data(), cols.place.data(), rows.cell.data(), rows.place.data(), octave.key,
             n, noise.data());
  }

  /// F of every column.
  std::vector<float> shape_row(double north_m) const {
    const std::size_t n = east_m_.size();
    std::vector<float> f(n, 1.0f);
    if (o_.shape == NoiseShape::plain) return f;
    std::vector<float> bend(n), noise(n);
    for (std::size_t i = 0; i < bends_.size(); ++i) {
      noise_of(bends_[i], bend_columns_[i], north_m, noise);
      const float weight = float(std::ldexp(o_.bend, -int(i)));
      for (std::size_t c = 0; c < n; ++c) bend[c] += weight * noise[c];
    }
    const double y = (north_m - patch_.south_m) / patch_.side_m;
    for (std::size_t c = 0; c < n; ++c) {
      const double x = x_of(east_m_[c]) + double(bend[c]);
      f[c] = float(o_.shape == NoiseShape::ridge ? std::max(0.0, std::min(2 * x, 2 - 2 * x))
                                                 : std::abs(x - y));
    }
    return f;
  }

  Warped warp_row(double north_m) const {
    Warped at;
    if (o_.warp <= 0) return at;
    const std::size_t n = east_m_.size();
    at = {east_m_, std::vector<double>(n, north_m)};
    std::vector<float> noise(n);
    const double reach_m = o_.warp * o_.wavelength_m;
    for (int axis = 0; axis < 2; ++axis) {
      const Octave octave = make_octave(o_.seed, kWarp, axis, 1 / o_.wavelength_m);
      noise_of(octave, places(octave), north_m, noise);
      auto& place = axis == 0 ? at.east_m : at.north_m;
      for (std::size_t c = 0; c < n; ++c) place[c] += reach_m * double(noise[c]);
    }
    return at;
  }

  /// What joins the first octave only: the sea level, and the rise of a valley's bed.
  void begin(double north_m, const std::vector<float>& shape, std::span<float> z,
             std::vector<float>& rough) const {
    const double y = o_.tilt == 0 ? 0 : (north_m - patch_.south_m) / patch_.side_m;
    for (std::size_t c = 0; c < z.size(); ++c) {
      if (o_.law == NoiseLaw::ridged) z[c] *= shape[c];
      z[c] += float(o_.c_0);
      if (o_.tilt != 0) z[c] += float(o_.tilt * (x_of(east_m_[c]) + y) / 2);
      if (o_.law == NoiseLaw::hybrid) rough[c] = z[c];
    }
  }

  NoiseOptions o_;
  Patch patch_;
  std::vector<double> east_m_;
  std::vector<Octave> octaves_, bends_;
  std::vector<Places> columns_, bend_columns_;
  std::vector<std::vector<float>> weights_;
};

/// Lattice coordinates must fit 32-bit integers.
void check_reach(const NoiseOptions& o, double farthest_m) {
  const double finest_m = o.wavelength_m / std::pow(o.lacunarity, o.octaves - 1);
  if (!(farthest_m / finest_m < 1e9))
    throw std::invalid_argument(
        fmt::format("octaves = {}; waves of {:.3g} m are too fine {:.3g} m from the origin",
                    o.octaves, finest_m, farthest_m));
}

void check_position(const NoiseOptions& o) {
  if (o.tilt != 0 && o.shape == NoiseShape::plain)
    throw std::invalid_argument(
        fmt::format("tilt = {}; must be 0 unless shape = ridge or valley", o.tilt));
}

}  // namespace

std::vector<Field> fields(NoiseOptions& o) {
  return {
      {"law", o.law, {"fbm", "heterogeneous", "hybrid", "ridged"}, "how octaves join the sum"},
      {"shape", o.shape, {"plain", "ridge", "valley"}, "what the first waves are multiplied with"},
      {"wavelength_m", o.wavelength_m, {1e-3, 1e9}, "m", "the longest waves"},
      {"octaves", o.octaves, {1, 48}, "", "how many wavelengths, each shorter by the lacunarity"},
      {"lacunarity", o.lacunarity, {1.01, 16}, "", "ratio of one wavelength to the next"},
      {"H", o.H, {-2, 4}, "", "smoothness: fractal dimension 3 - H; mountains have about 0.8"},
      {"H_law",
       o.H_law,
       {"constant", "linear", "filling"},
       "how H changes eastward: not, to H_east, or as 1/x - 3/2"},
      {"H_east", o.H_east, {-2, 4}, "", "H at the patch's eastern edge, with H_law = linear"},
      {"relief_m",
       o.relief_m,
       {-1e6, 1e6},
       "m",
       "height of 1: three deviations of the first waves"},
      {"c_t", o.c_t, {-10, 10}, "", "added to each octave's noise"},
      {"c_s", o.c_s, {0, 10}, "", "scale of each octave's noise"},
      {"c_0", o.c_0, {-10, 10}, "", "added to the first octave: the terrain's zero"},
      {"gain", o.gain, {0, 16}, "", "how much a ridge roughens what lies on it; law = ridged"},
      {"bend", o.bend, {0, 2}, "", "how far 1/f^3 noise bends ridge or valley, in patch sides"},
      {"tilt", o.tilt, {-10, 10}, "", "rise of ridge or valley from south-west to north-east"},
      {"warp", o.warp, {0, 10}, "", "displacement of places by noise, in longest wavelengths"},
      {"patch_m", o.patch_m, {0, 1e9}, "m", "side of the patch of laws by position; 0: the canvas"},
      {"patch_west_m", o.patch_west_m, {-1e9, 1e9}, "m", "its western edge, when patch_m > 0"},
      {"patch_south_m", o.patch_south_m, {-1e9, 1e9}, "m", "its southern edge, when patch_m > 0"},
      {"seed", o.seed, "of random numbers"}};
}

float gradient_noise(double x, double y, std::uint64_t seed) {
  std::int32_t col = 0, row = 0;
  float u = 0, v = 0;
  split(x, col, u);
  split(y, row, v);
  return noise_in_cell(col, u, row, v, std::uint32_t(mix(seed)));
}

Raster<float> generate_noise(const Canvas& canvas, const NoiseOptions& options, const Run& run) {
  check_canvas(canvas);
  check_options(options);
  check_position(options);
  const int cols = canvas.size.cols, rows = canvas.size.rows;
  const double west = canvas.east_m(0), east = canvas.east_m(cols - 1);
  const double north = canvas.north_m(0), south = canvas.north_m(rows - 1);
  check_reach(options,
              std::max({std::abs(west), std::abs(east), std::abs(north), std::abs(south)}));

  Patch patch{options.patch_west_m, options.patch_south_m, options.patch_m};
  if (patch.side_m == 0) {
    patch = {std::min(west, east), std::min(north, south),
             std::max(std::abs(east - west), std::abs(north - south))};
    if (patch.side_m == 0) patch.side_m = canvas.spacing.dx_m;  // a single cell
  }
  std::vector<double> east_m(static_cast<std::size_t>(cols));
  for (int c = 0; c < cols; ++c) east_m[std::size_t(c)] = canvas.east_m(c);
  const Terrain terrain(options, std::move(east_m), patch);

  Raster<float> z(canvas.size);
  with_threads(run.threads, [&] {
    constexpr int kRowsAtOnce = 64;
    for (int first = 0; first < rows; first += kRowsAtOnce) {
      run.report(double(first) / rows, "noise");
      parallel_for(first, std::min(rows, first + kRowsAtOnce), 4,
                   [&](int r) { terrain.row(canvas.north_m(r), z.row(r)); });
    }
  });
  return z;
}

float noise_height_m(double east_m, double north_m, const NoiseOptions& options) {
  check_options(options);
  check_position(options);
  if (!std::isfinite(east_m) || !std::isfinite(north_m))
    throw std::invalid_argument(fmt::format("place = ({}, {}); must be finite", east_m, north_m));
  if (goes_by_position(options) && options.patch_m == 0)
    throw std::invalid_argument("patch_m = 0; must be > 0 for laws by position at a single place");
  check_reach(options, std::max(std::abs(east_m), std::abs(north_m)));
  float z = 0;
  Terrain(options, {east_m}, {options.patch_west_m, options.patch_south_m, options.patch_m})
      .row(north_m, {&z, 1});
  return z;
}

}  // namespace dem
