#include "spline/spline_sample.h"

#include <cmath>

#include "dem/breaklines.h"
#include "numeric/parallel.h"
#include "numeric/random.h"

namespace dem::spline {
using namespace numeric;
namespace {

constexpr int difference[4][4] = {{1, 0, 0, 0}, {-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};

/// Close to a standard normal number: the sum of four uniform ones. The solve adds up many of them.
double normal(std::uint64_t bits) {
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += double((bits >> (16 * k)) & 0xffff) + 0.5;
  return (sum / 65536 - 2) * 1.7320508075688772;
}

std::uint64_t stream_of(int index, int i, int j) {
  return std::uint64_t(index) * 16 + std::uint64_t(4 * i + j);
}

/// Pulls of the springs Dx^i Dy^j that touch row y, added to it.
void add_pulls(double root_c, int i, int j, const Mask& breaks, Size size, std::uint64_t seed,
               std::uint64_t stream, int y, std::vector<double>& row) {
  for (int k = 0; k <= j; ++k) {
    const int first = y - k;  // the spring's first row
    if (first < 0 || first + j >= size.rows) continue;
    for (int x = 0; x + i < size.cols; ++x) {
      if (is_broken(breaks, x, first, i + 1, j + 1)) continue;
      const double pull = root_c * difference[j][k] * normal(random_bits(seed, stream, x, first));
      for (int m = 0; m <= i; ++m) row[std::size_t(x + m)] += pull * difference[i][m];
    }
  }
}

}  // namespace

Grid<float> spring_noise(const Springs& springs, const Mask& breaks, Size size,
                         const Grid<float>& w, std::uint64_t seed, int index) {
  Grid<float> f(size);
  parallel_for(0, size.rows, 16, [&](int y) {
    std::vector<double> row(std::size_t(size.cols), 0.);
    for (int i = 0; i <= 3; ++i)
      for (int j = 0; i + j <= 3; ++j)
        if (springs.c[i][j] > 0)
          add_pulls(std::sqrt(springs.c[i][j]), i, j, breaks, size, seed, stream_of(index, i, j), y,
                    row);
    if (!w.empty())
      for (int x = 0; x < size.cols; ++x)
        row[std::size_t(x)] += std::sqrt(double(w.row(y)[x])) *
                               normal(random_bits(seed, stream_of(index, 0, 0), x, y));
    for (int x = 0; x < size.cols; ++x) f.row(y)[x] = float(row[std::size_t(x)]);
  });
  return f;
}

double spring_energy(const Springs& springs, const Mask& breaks, const Grid<double>& z) {
  const Size size = z.size();
  std::vector<double> rows(std::size_t(size.rows), 0.);
  parallel_for(0, size.rows, 16, [&](int y) {
    for (int i = 0; i <= 3; ++i)
      for (int j = 0; i + j <= 3; ++j) {
        if (springs.c[i][j] == 0 || y + j >= size.rows) continue;
        double sum = 0;
        for (int x = 0; x + i < size.cols; ++x) {
          if (is_broken(breaks, x, y, i + 1, j + 1)) continue;
          double d = 0;
          for (int k = 0; k <= j; ++k)
            for (int m = 0; m <= i; ++m)
              d += difference[j][k] * difference[i][m] * z.row(y + k)[x + m];
          sum += d * d;
        }
        rows[std::size_t(y)] += springs.c[i][j] * sum;
      }
  });
  double total = 0;
  for (const double r : rows) total += r;
  return total;
}

std::size_t DistanceLaw::bin_of(std::uint16_t fifths) {
  return std::min(bins - 1, std::size_t(3 * std::log2(fifths / 5. + 1e-9)));
}

void DistanceLaw::add(const Grid<double>& sample, const Raster<std::uint16_t>& distance) {
  for (int y = 0; y < distance.rows(); ++y)
    for (int x = 0; x < distance.cols(); ++x) {
      const std::uint16_t d = distance(x, y);
      if (d == 0) continue;
      const std::size_t bin = bin_of(d);
      sum_[bin] += sample.row(y)[x] * sample.row(y)[x];
      centre_[bin] += d;
      ++count_[bin];
    }
}

void DistanceLaw::finish() {
  double largest = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    if (count_[b] == 0) continue;
    centre_[b] /= count_[b];
    mean_[b] = largest = std::max(largest, sum_[b] / count_[b]);
  }
}

double DistanceLaw::variance(double fifths) const {
  // Linear between the bins' mean distances; proportional to the distance before the first.
  double x0 = 0, v0 = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    if (count_[b] == 0) continue;
    if (fifths <= centre_[b]) return v0 + (mean_[b] - v0) * (fifths - x0) / (centre_[b] - x0);
    x0 = centre_[b];
    v0 = mean_[b];
  }
  return v0;
}

}  // namespace dem::spline
