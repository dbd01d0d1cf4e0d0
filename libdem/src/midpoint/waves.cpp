// The bottom-up pass in the order of [belhadj2007] algorithm 1.

#include <cmath>
#include <vector>

#include "midpoint/lattice.h"
#include "midpoint/midpoint.h"
#include "numeric/parallel.h"
#include "numeric/random.h"

namespace dem::midpoint {
using namespace numeric;
namespace {

constexpr std::uint64_t stream_up = 2;
constexpr std::uint8_t in_this_wave = 2;  // `known` of a cell whose height is being computed

/// The cells of a wave, as indices into the raster.
using Wave = std::vector<std::uint32_t>;

/// Adds the unknown ascendants of a cell to the next wave, each once.
void push(const Lattice& lattice, int col, int row, Mask& known, Wave& next) {
  lattice.for_each_ascendant(col, row, [&](int c, int r) {
    if (known(c, r) != 0) return;
    known(c, r) = in_this_wave;
    next.push_back(std::uint32_t(r) * std::uint32_t(known.cols()) + std::uint32_t(c));
  });
}

/// The weighted mean of a cell's known children, of which there is at least one.
float mean_of_children(const Midpoint& fill, const Pull& pull, const UpNoise& noise,
                       const Lattice& lattice, const Dem& dem, int col, int row) {
  double sum = 0, weights = 0, distances = 0;
  int n = 0;
  lattice.for_each_child(col, row, [&](int c, int r) {
    if (dem.known(c, r) != 1) return;
    const double d = std::hypot(double(c - col), double(r - row));
    const std::size_t kind = fill.kinds.empty() ? 0 : std::size_t(fill.kinds(c, r));
    const double weight = std::pow(d, -pull.weight_exponent);
    const double height = double(dem.z(c, r)) - double(fill.reference_m);
    sum += weight * bend_factor(pull.bend[kind], d / fill.diagonal()) * height;
    weights += weight;
    distances += d;
    ++n;
  });
  double mean = sum / weights;
  if (noise.scale != 0)
    mean += noise.scale * (distances / n) *
            signed_uniform(random_bits(noise.seed, stream_up, col, row));
  return float(mean + double(fill.reference_m));
}

}  // namespace

Dem carry_up_in_waves(const Midpoint& fill, const Pull& pull, const UpNoise& noise) {
  const Lattice lattice(fill.dem.size(), fill.subdivision);
  const int cols = fill.dem.z.cols(), rows = fill.dem.z.rows();
  Dem dem = fill.dem;
  for (auto& k : dem.known.cells()) k = k != 0;

  // The first wave is the known cells themselves, read off the mask.
  Wave wave, next;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col)
      if (fill.dem.known(col, row)) push(lattice, col, row, dem.known, next);

  for (int waves = 1; !next.empty(); ++waves) {
    fill.run.report(1 - 1.0 / (1 + waves), "bottom-up");
    wave.swap(next);
    next.clear();
    const auto col_of = [&](std::uint32_t i) { return int(i % std::uint32_t(cols)); };
    const auto row_of = [&](std::uint32_t i) { return int(i / std::uint32_t(cols)); };

    constexpr std::size_t block = 4096;
    with_threads(fill.run.threads, [&] {
      parallel_for(0, int((wave.size() + block - 1) / block), 1, [&](int b) {
        const std::size_t end = std::min(wave.size(), std::size_t(b + 1) * block);
        for (std::size_t n = std::size_t(b) * block; n < end; ++n)
          dem.z.cells()[wave[n]] =
              mean_of_children(fill, pull, noise, lattice, dem, col_of(wave[n]), row_of(wave[n]));
      });
    });
    for (auto i : wave) dem.known.cells()[i] = 1;
    for (auto i : wave) push(lattice, col_of(i), row_of(i), dem.known, next);
  }
  return dem;
}

}  // namespace dem::midpoint
