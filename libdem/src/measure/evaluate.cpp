#include "dem/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <unsupported/Eigen/FFT>

#include "numeric/gradient.h"
#include "numeric/parallel.h"

namespace dem {
using namespace numeric;
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kRowsAtOnce = 1024;

void check_spacing(Spacing cell) {
  if (!(cell.dx_m > 0 && cell.dy_m > 0 && std::isfinite(cell.dx_m) && std::isfinite(cell.dy_m)))
    throw std::invalid_argument(
        fmt::format("spacing = {} x {} m; must be > 0", cell.dx_m, cell.dy_m));
}

void check_spacing(std::span<const Spacing> spacing, Size size) {
  if (spacing.size() != 1 && spacing.size() != std::size_t(size.rows))
    throw std::invalid_argument(fmt::format(
        "spacing has {} entries; must be 1 or {}, the number of rows", spacing.size(), size.rows));
  for (const auto& cell : spacing) check_spacing(cell);
}

void check_size(const char* name, Size size, Size expected) {
  if (size != expected)
    throw std::invalid_argument(fmt::format("{} is {} x {}; must be {} x {} as truth", name,
                                            size.cols, size.rows, expected.cols, expected.rows));
}

/// The tangent of Horn's slope; the cell must have eight neighbours.
double steepness(const Raster<float>& z, int col, int row, Spacing cell) {
  return std::sqrt(inner_gradient(z.row(row - 1), z.row(row), z.row(row + 1), col, cell).squared());
}

/// Calls each(row) for all rows, in parallel, and reports now and then.
template <class Each>
void for_rows(int rows, const Run& run, const char* what, Each each) {
  for (int first = 0; first < rows; first += kRowsAtOnce) {
    run.report(double(first) / rows, what);
    with_threads(run.threads,
                 [&] { parallel_for(first, std::min(rows, first + kRowsAtOnce), 16, each); });
  }
  run.report(1, what);
}

/// What one row adds to the errors.
struct RowSums {
  double e = 0, squares = 0, absolute = 0, largest = 0;
  double slope_squares = 0;
  std::size_t slopes = 0;

  void add(const RowSums& row) {
    e += row.e;
    squares += row.squares;
    absolute += row.absolute;
    largest = std::max(largest, row.largest);
    slope_squares += row.slope_squares;
    slopes += row.slopes;
  }
};

/// The value of 0-based rank `rank` in sorted order. Reorders `values`.
double ranked(std::vector<float>& values, std::size_t rank) {
  const auto at = values.begin() + std::ptrdiff_t(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The median; of an even number the mean of the two in the middle. Reorders `values`.
double median(std::vector<float>& values) {
  const std::size_t half = values.size() / 2;
  const double upper = ranked(values, half);
  if (values.size() % 2 == 1) return upper;
  return (upper + *std::max_element(values.begin(), values.begin() + std::ptrdiff_t(half))) / 2;
}

/// The largest n up to `most` with no prime factor above 7.
int smooth_size(int most) {
  for (int n = most;; --n) {
    int rest = n;
    for (const int p : {2, 3, 5, 7})
      while (rest % p == 0) rest /= p;
    if (rest == 1) return n;
  }
}

/// z minus its least-squares plane over the given part.
Raster<double> without_plane(const Raster<float>& z, Size part) {
  // On a full rectangle 1, x and y from the middle are orthogonal: three separate sums.
  const double middle_x = (part.cols - 1) / 2.0, middle_y = (part.rows - 1) / 2.0;
  double sum = 0, sum_x = 0, sum_y = 0, square_x = 0, square_y = 0;
  for (int row = 0; row < part.rows; ++row)
    for (int col = 0; col < part.cols; ++col) {
      const double x = col - middle_x, y = row - middle_y, height = z(col, row);
      sum += height;
      sum_x += height * x;
      sum_y += height * y;
      square_x += x * x;
      square_y += y * y;
    }
  const double mean = sum / double(part.cells());
  const double per_col = part.cols > 1 ? sum_x / square_x : 0;
  const double per_row = part.rows > 1 ? sum_y / square_y : 0;
  Raster<double> rest(part);
  for (int row = 0; row < part.rows; ++row)
    for (int col = 0; col < part.cols; ++col)
      rest(col, row) = z(col, row) - mean - per_col * (col - middle_x) - per_row * (row - middle_y);
  return rest;
}

/// Hann's window over n cells: zero half a cell outside them, one in the middle.
std::vector<double> hann(int n) {
  std::vector<double> window(std::size_t(n), 1.0);
  for (int i = 0; i < n; ++i) {
    const double s = std::sin(std::numbers::pi * (i + 0.5) / n);
    window[std::size_t(i)] = s * s;
  }
  return window;
}

double sum_of_squares(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return sum;
}

/// The Fourier transform of a real raster: columns 0 to cols / 2, all rows.
Raster<std::complex<double>> transform(const Raster<double>& z) {
  const auto cols = std::size_t(z.cols()), rows = std::size_t(z.rows());
  Raster<std::complex<double>> waves({z.cols() / 2 + 1, z.rows()});
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> in(std::max(cols, rows)), out(in.size());
  const auto transform_line = [&](std::size_t n) {
    if (n > 1)
      fft.fwd(out.data(), in.data(), Eigen::Index(n));
    else
      out[0] = in[0];
  };
  for (int row = 0; row < z.rows(); ++row) {
    std::copy_n(z.row(row).begin(), cols, in.begin());
    transform_line(cols);
    std::copy_n(out.begin(), waves.cols(), waves.row(row).begin());
  }
  for (int col = 0; col < waves.cols(); ++col) {
    for (int row = 0; row < z.rows(); ++row) in[std::size_t(row)] = waves(col, row);
    transform_line(rows);
    for (int row = 0; row < z.rows(); ++row) waves(col, row) = out[std::size_t(row)];
  }
  return waves;
}

}  // namespace

Errors compare(const Raster<float>& truth, const Raster<float>& got, const Mask& where,
               std::span<const Spacing> spacing, const Run& run) {
  const Size size = truth.size();
  check_size("got", got.size(), size);
  check_size("where", where.size(), size);
  check_spacing(spacing, size);

  // Where each row's errors begin in the list of all.
  std::vector<std::size_t> begin(std::size_t(size.rows) + 1);
  for (int row = 0; row < size.rows; ++row) {
    std::size_t n = 0;
    for (const auto w : where.row(row)) n += w != 0;
    begin[std::size_t(row) + 1] = begin[std::size_t(row)] + n;
  }
  if (begin.back() == 0)
    throw std::invalid_argument("where has no cell that is 1; at least one is needed");

  // Errors, and sums over each row.
  std::vector<float> errors(begin.back());
  std::vector<RowSums> rows(std::size_t(size.rows));
  for_rows(size.rows, run, "errors", [&](int row) {
    const auto r = std::size_t(row);
    const Spacing cell = spacing[spacing.size() == 1 ? 0 : r];
    const bool inner_row = row > 0 && row < size.rows - 1;
    RowSums sums;
    std::size_t at = begin[r];
    for (int col = 0; col < size.cols; ++col) {
      if (!where(col, row)) continue;
      const double e = double(got(col, row)) - double(truth(col, row));
      errors[at++] = float(e);
      sums.add({e, e * e, std::abs(e), std::abs(e)});
      if (!inner_row || col == 0 || col == size.cols - 1) continue;
      // atan a - atan b = atan((a - b) / (1 + a b)) for a, b >= 0
      const double a = steepness(got, col, row, cell), b = steepness(truth, col, row, cell);
      const double slope = std::atan((a - b) / (1 + a * b)) * kDegrees;
      sums.slope_squares += slope * slope;
      ++sums.slopes;
    }
    rows[r] = sums;
  });
  RowSums all;
  for (const auto& row : rows) all.add(row);

  // Order statistics.
  const auto n = double(errors.size());
  const double middle = median(errors);
  std::vector<float> deviations(errors.size());
  std::ranges::transform(errors, deviations.begin(),
                         [=](float e) { return float(std::abs(e - middle)); });
  std::ranges::transform(errors, errors.begin(), [](float e) { return std::abs(e); });
  const std::size_t rank90 = (errors.size() * 9 + 9) / 10;  // 90 % of the cells, rounded up
  return {
      .cells = errors.size(),
      .rmse_m = std::sqrt(all.squares / n),
      .mae_m = all.absolute / n,
      .bias_m = all.e / n,
      .nmad_m = 1.4826 * median(deviations),
      .le90_m = ranked(errors, rank90 - 1),
      .max_m = all.largest,
      .slope_rmse_deg = all.slopes == 0 ? kNaN : std::sqrt(all.slope_squares / double(all.slopes))};
}

Raster<float> slope_deg(const Raster<float>& z, std::span<const Spacing> spacing, const Run& run) {
  check_spacing(spacing, z.size());
  Raster<float> slope(z.size());
  for_rows(z.rows(), run, "slopes", [&](int row) {
    if (row == 0 || row == z.rows() - 1) return;
    const Spacing cell = spacing[spacing.size() == 1 ? 0 : std::size_t(row)];
    for (int col = 1; col < z.cols() - 1; ++col)
      slope(col, row) = float(std::atan(steepness(z, col, row, cell)) * kDegrees);
  });
  return slope;
}

std::vector<SpectrumBin> power_spectrum(const Raster<float>& z, Spacing spacing, int per_octave) {
  if (z.empty()) throw std::invalid_argument("z has no cells; at least one is needed");
  check_spacing(spacing);
  if (per_octave < 1)
    throw std::invalid_argument(fmt::format("per_octave = {}; must be >= 1", per_octave));

  // Plane removed, windowed, transformed.
  const Size part{smooth_size(z.cols()), smooth_size(z.rows())};
  Raster<double> rest = without_plane(z, part);
  const auto window_x = hann(part.cols), window_y = hann(part.rows);
  for (int row = 0; row < part.rows; ++row)
    for (int col = 0; col < part.cols; ++col)
      rest(col, row) *= window_x[std::size_t(col)] * window_y[std::size_t(row)];
  const auto waves = transform(rest);
  const double scale =
      spacing.dx_m * spacing.dy_m / (sum_of_squares(window_x) * sum_of_squares(window_y));

  // Rings from the longest wave to the shortest that all directions have.
  const double length_x = part.cols * spacing.dx_m, length_y = part.rows * spacing.dy_m;
  const double longest = std::max(length_x, length_y);
  const double shortest =
      2 * std::max(part.cols > 1 ? spacing.dx_m : 0.0, part.rows > 1 ? spacing.dy_m : 0.0);
  std::vector<SpectrumBin> rings;
  for (int row = 0; row < part.rows; ++row) {
    const double ky = (2 * row <= part.rows ? row : row - part.rows) / length_y;
    for (int col = 0; col < waves.cols(); ++col) {
      // A real surface has each wave twice, as (col, row) and (-col, -row): count it once.
      if ((col == 0 || 2 * col == part.cols) && 2 * row > part.rows) continue;
      const double kx = col / length_x, k = std::sqrt(kx * kx + ky * ky);
      if (k == 0 || k * shortest > 1 + 1e-12) continue;
      const auto ring = std::size_t(std::floor(per_octave * std::log2(k * longest) + 0.5));
      if (ring >= rings.size()) rings.resize(ring + 1);
      rings[ring].power_m2 += std::norm(waves(col, row)) * scale;
      ++rings[ring].waves;
    }
  }
  std::vector<SpectrumBin> bins;
  for (std::size_t i = 0; i < rings.size(); ++i)
    if (rings[i].waves > 0)
      bins.push_back({longest * std::exp2(-double(i) / per_octave),
                      rings[i].power_m2 / double(rings[i].waves), rings[i].waves});
  return bins;
}

double spectral_slope(std::span<const SpectrumBin> spectrum, double shortest_m, double longest_m) {
  // Least squares of log power = a - beta * log wavenumber.
  double n = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  for (const auto& bin : spectrum) {
    if (bin.wavelength_m < shortest_m || bin.wavelength_m > longest_m || !(bin.power_m2 > 0))
      continue;
    const double x = -std::log(bin.wavelength_m), y = std::log(bin.power_m2);
    n += 1;
    sum_x += x;
    sum_y += y;
    sum_xx += x * x;
    sum_xy += x * y;
  }
  if (n < 2) return kNaN;
  return -(n * sum_xy - sum_x * sum_y) / (n * sum_xx - sum_x * sum_x);
}

}  // namespace dem
