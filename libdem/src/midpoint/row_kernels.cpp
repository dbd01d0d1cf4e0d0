#include "midpoint/row_kernels.h"

#include <algorithm>
#include <limits>

#include "numeric/simd.h"

namespace dem::midpoint {
namespace {

inline std::int32_t mask_of(bool condition) { return -std::int32_t(condition); }

}  // namespace

DEM_VECTORISED void sum_neighbours(const Rows& z, const Cross& cross, Take take, int n,
                                   float* out) {
  const float* __restrict up = z.up;
  const float* __restrict here = z.here;
  const float* __restrict down = z.down;
  float* __restrict sum = out;
  const Cross w = cross;
  if (take == Take::sides)
    for (int x = 1; x < n - 2; ++x)
      sum[x] = (w.l * here[x - 1] + w.r * here[x + 1]) + (w.u * up[x] + w.d * down[x]);
  else if (take == Take::corners)
    for (int x = 1; x < n - 2; ++x)
      sum[x] = (w.ul * up[x - 1] + w.ur * up[x + 1]) + (w.dl * down[x - 1] + w.dr * down[x + 1]);
  else
    for (int x = 1; x < n - 2; ++x)
      sum[x] = ((w.l * here[x - 1] + w.r * here[x + 1]) + (w.u * up[x] + w.d * down[x])) +
               ((w.ul * up[x - 1] + w.ur * up[x + 1]) + (w.dl * down[x - 1] + w.dr * down[x + 1]));
}

void add_neighbours(const Rows& z, const Cross& w, Take take, int n, float* out) {
  const float* up = z.up;
  const float* here = z.here;
  const float* down = z.down;
  for (int x = 1; x < n - 2; ++x) {
    const float side = (w.l * here[x - 1] + w.r * here[x + 1]) + (w.u * up[x] + w.d * down[x]);
    const float corner =
        (w.ul * up[x - 1] + w.ur * up[x + 1]) + (w.dl * down[x - 1] + w.dr * down[x + 1]);
    out[x] += take == Take::sides ? side : take == Take::corners ? corner : side + corner;
  }
}

DEM_VECTORISED void load_known(const float* z_row, const std::uint8_t* mask_row, float reference,
                               int n, float* height_row, float* known_row) {
  const float* __restrict z = z_row;
  const std::uint8_t* __restrict mask = mask_row;
  float* __restrict height = height_row;
  float* __restrict known = known_row;
  for (int x = 0; x < n; ++x) {
    const std::int32_t is_known = mask_of(mask[x] != 0);
    known[x] = choose(is_known, 1.0f, 0.0f);
    height[x] = choose(is_known, z[x] - reference, 0.0f);
  }
}

DEM_VECTORISED void load_settled(const float* z_row, const float* weight_row, int n,
                                 float* height_row, float* known_row) {
  const float* __restrict z = z_row;
  const float* __restrict weight = weight_row;
  float* __restrict height = height_row;
  float* __restrict known = known_row;
  for (int x = 0; x < n; ++x) {
    const std::int32_t is_known = mask_of(weight[x] < 0);
    known[x] = choose(is_known, 1.0f, 0.0f);
    height[x] = choose(is_known, z[x], 0.0f);
  }
}

DEM_VECTORISED void complete_reached(const std::int32_t* young_row, const float* sum_row,
                                     const float* weight_row, int n, float* height_row,
                                     float* known_row) {
  const std::int32_t* __restrict young = young_row;
  const float* __restrict sum = sum_row;
  const float* __restrict weight = weight_row;
  float* __restrict height = height_row;
  float* __restrict known = known_row;
  for (int x = 0; x < n; ++x) {
    const std::int32_t take = young[x] & mask_of(known[x] == 0) & mask_of(weight[x] > 0);
    const float nonzero = choose(take, weight[x], 1.0f);
    height[x] = choose(take, sum[x] / nonzero, height[x]);
    known[x] = choose(take, 1.0f, known[x]);
  }
}

DEM_VECTORISED void complete_unknown(const std::int32_t* young_row, const float* sum_row,
                                     const float* known_row, int n, float* height_row) {
  const std::int32_t* __restrict young = young_row;
  const float* __restrict sum = sum_row;
  const float* __restrict known = known_row;
  float* __restrict height = height_row;
  for (int x = 0; x < n; ++x)
    height[x] = choose(young[x] & mask_of(known[x] == 0), sum[x], height[x]);
}

DEM_VECTORISED void store_known(const float* z_row, const std::uint8_t* known_row, float reference,
                                const std::int32_t* young_row, std::int32_t other,
                                const float* sum_row, const float* here_row, int n, float* to_row) {
  const float* __restrict z = z_row;
  const std::uint8_t* __restrict known = known_row;
  const std::int32_t* __restrict young = young_row;
  const float* __restrict sum = sum_row;
  const float* __restrict here = here_row;
  float* __restrict to = to_row;
  for (int x = 0; x < n; ++x) {
    const float height = choose(young[x] ^ other, sum[x], here[x]) + reference;
    to[x] = choose(mask_of(known[x] != 0), z[x], height);
  }
}

DEM_VECTORISED void settle_row(const std::int32_t* young_row, std::int32_t other,
                               const float* sum_row, const float* more_row, int n, float* z_row,
                               float* weight_row) {
  const std::int32_t* __restrict young = young_row;
  const float* __restrict sum = sum_row;
  const float* __restrict more = more_row;
  float* __restrict z = z_row;
  float* __restrict weight = weight_row;
  for (int x = 0; x < n; ++x) {
    const float total = weight[x] + more[x];
    const std::int32_t take = (young[x] ^ other) & mask_of(weight[x] >= 0) & mask_of(total > 0);
    z[x] = choose(take, (z[x] + sum[x]) / choose(take, total, 1.0f), z[x]);
    weight[x] = choose(take, settled, weight[x]);
  }
}

DEM_VECTORISED void add_own(const float* height_row, const float* known_row, const float* own_row,
                            const float* own_weight_row, int n, float* sum_row, float* weight_row) {
  const float* __restrict height = height_row;
  const float* __restrict known = known_row;
  const float* __restrict own = own_row;
  const float* __restrict own_weight = own_weight_row;
  float* __restrict sum = sum_row;
  float* __restrict weight = weight_row;
  for (int x = 0; x < n; ++x) {
    const std::int32_t is_known = mask_of(known[x] != 0);
    sum[x] = choose(is_known, height[x], own[x] + sum[x]);
    weight[x] = choose(is_known, settled, own_weight[x] + weight[x]);
  }
}

// Floats are compared as integers that are in the same order: the compiler takes those side by
// side.
DEM_VECTORISED float lowest_of_known(const float* z_row, const std::uint8_t* known_row, int n) {
  const float* __restrict z = z_row;
  const std::uint8_t* __restrict known = known_row;
  const auto ordered = [](std::int32_t bits) { return bits ^ ((bits >> 31) & 0x7fffffff); };
  const std::int32_t none = std::bit_cast<std::int32_t>(std::numeric_limits<float>::infinity());
  std::int32_t least = none;
  for (int x = 0; x < n; ++x) {
    const std::int32_t is_known = mask_of(known[x] != 0);
    const std::int32_t height = ordered(std::bit_cast<std::int32_t>(z[x]));
    least = std::min(least, (height & is_known) | (none & ~is_known));
  }
  return std::bit_cast<float>(ordered(least));
}

}  // namespace dem::midpoint
