#pragma once
// Points, directions and lines of cells, for generators. Private to the library. Arithmetic and
// square roots only: a seed draws the same lines on every machine.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "dem/dem.h"
#include "numeric/random.h"

namespace dem::synthesis {

/// Throws std::invalid_argument unless a map has from least x least to 2^28 cells, of a positive
/// size. `what` is to be made on it.
void check_map(Size size, Spacing spacing, int least, std::string_view what);

struct Point {
  double x = 0, y = 0;

  friend Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
  friend Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
  friend Point operator*(double s, Point a) { return {s * a.x, s * a.y}; }
};

inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
inline double length(Point a) { return std::sqrt(dot(a, a)); }
inline Point left_of(Point direction) { return {direction.y, -direction.x}; }  // y grows southward

/// Turned to the left by 2 atan(half_tangent).
inline Point turned(Point a, double half_tangent) {
  const double t = half_tangent, n = 1 / (1 + t * t);
  return n * ((1 - t * t) * a + 2 * t * left_of(a));
}

/// Uniform in [0, 1).
inline double uniform(numeric::Sequence& random) {
  return (numeric::signed_uniform(random.bits()) + 1) / 2;
}

/// Mean 0, variance 1: the sum of twelve uniform numbers.
inline double gaussian(numeric::Sequence& random) {
  double sum = 0;
  for (int i = 0; i < 12; ++i) sum += numeric::signed_uniform(random.bits());
  return sum / 2;
}

/// A direction, each equally likely.
inline Point random_direction(numeric::Sequence& random) {
  for (;;) {
    const Point p{numeric::signed_uniform(random.bits()), numeric::signed_uniform(random.bits())};
    if (const double r = length(p); r > 0.01 && r < 1) return (1 / r) * p;
  }
}

/// 2^-x for x in [0, 1].
inline double half_to_the(double x) {
  double result = 1, root = 0.5;
  for (int bit = 0; bit < 40 && x > 0; ++bit) {
    if (x >= 1) result *= root, x -= 1;
    root = std::sqrt(root), x *= 2;
  }
  return result;
}

/// e^-u for u >= 0 within 0.01, and exactly 0 from 32 on: (1 - u / 32)^32.
inline double bell(double u) {
  double b = std::max(0.0, 1 - u / 32);
  for (int squarings = 0; squarings < 5; ++squarings) b *= b;
  return b;
}

/// Fractional Brownian motion at 2^levels + 1 even steps, 0 at the first and `end` at the last; the
/// midpoint of a part of length l (all = 1) moves by scale * l^H * gaussian. More levels add detail
/// and change nothing coarser.
inline std::vector<double> brownian_path(int levels, double end, double scale, double H,
                                         std::uint64_t seed, std::uint64_t stream) {
  const int n = 1 << levels;
  std::vector<double> path(std::size_t(n) + 1);
  path.back() = end;
  const double ratio = half_to_the(H);
  for (int level = 0; level < levels; ++level, scale *= ratio) {
    const int step = n >> level;
    for (int i = step / 2; i < n; i += step) {
      numeric::Sequence random(seed ^ numeric::mix(stream),
                               numeric::random_bits(seed, stream, level, i / step));
      path[std::size_t(i)] =
          (path[std::size_t(i - step / 2)] + path[std::size_t(i + step / 2)]) / 2 +
          scale * gaussian(random);
    }
  }
  return path;
}

/// Calls each(cell) for the cells of a straight line after `from`, up to and with `to`, each a
/// neighbour of the one before, until each() returns false.
template <class Each>
void walk_line(Cell from, Cell to, Each each) {
  const int dc = to.col - from.col, dr = to.row - from.row;
  const int n = std::max(std::abs(dc), std::abs(dr));
  const auto part = [n](int d, int i) {  // d * i / n, rounded
    const long long twice = 2LL * d * i;
    return int((twice >= 0 ? twice + n : twice - n) / (2LL * n));
  };
  for (int i = 1; i <= n; ++i)
    if (!each(Cell{from.col + part(dc, i), from.row + part(dr, i)})) return;
}

}  // namespace dem::synthesis
