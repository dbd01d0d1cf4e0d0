#pragma once
// The inner loops of the pyramid: straight loops over a row, without branches. Private.
// They are compiled for plain x86-64 and for AVX2, and the machine takes the better one; neither
// fuses multiply and add, so both give the same bits.

#include <bit>
#include <cstdint>

namespace dem::midpoint {

/// Weights of the eight neighbours: left, right, up, down, and the corners between.
struct Cross {
  float l = 0, r = 0, u = 0, d = 0, ul = 0, ur = 0, dl = 0, dr = 0;
};

/// Three rows of nodes; the outer two may be rows of zeros.
struct Rows {
  const float* up;
  const float* here;
  const float* down;
};

/// Which neighbours a sum takes.
enum class Take { sides, corners, both };

/// out[x] = the weighted neighbours of node x, for 1 <= x < n - 2.
/// Sums are paired so that a mirrored raster gives the mirrored sum, bit for bit.
void sum_neighbours(const Rows& z, const Cross& w, Take take, int n, float* out);

/// out[x] += the same.
void add_neighbours(const Rows& z, const Cross& w, Take take, int n, float* out);

/// Heights relative to a reference where the mask is set, else 0; known: 1 or 0.
void load_known(const float* z, const std::uint8_t* mask, float reference, int n, float* height,
                float* known);

/// The same from nodes that are known where their weight is negative.
void load_settled(const float* z, const float* weight, int n, float* height, float* known);

/// In the young columns, unknown nodes that were reached become sum / weight, and known.
void complete_reached(const std::int32_t* young, const float* sum, const float* weight, int n,
                      float* height, float* known);

/// In the young columns, unknown nodes become sum.
void complete_unknown(const std::int32_t* young, const float* sum, const float* known, int n,
                      float* height);

/// to[x] = z[x] where known, else reference + (edge ? sum[x] : here[x]); edges are the columns
/// where young ^ other is set.
void store_known(const float* z, const std::uint8_t* known, float reference,
                 const std::int32_t* young, std::int32_t other, const float* sum, const float* here,
                 int n, float* to);

/// The weight of a node that is known.
constexpr float settled = -1;

/// Where young ^ other is set, nodes that are not settled and have weight become
/// (z + sum) / (weight + more), and settled.
void settle_row(const std::int32_t* young, std::int32_t other, const float* sum, const float* more,
                int n, float* z, float* weight);

/// Where known, sum becomes the height and weight `settled`; elsewhere their own are added to both.
void add_own(const float* height, const float* known, const float* own, const float* own_weight,
             int n, float* sum, float* weight);

/// The least z where known is set; infinity when it is nowhere.
float lowest_of_known(const float* z, const std::uint8_t* known, int n);

/// yes where the mask is all ones, no where it is zero: a choice without a branch.
inline float choose(std::int32_t mask, float yes, float no) {
  return std::bit_cast<float>((std::bit_cast<std::int32_t>(yes) & mask) |
                              (std::bit_cast<std::int32_t>(no) & ~mask));
}

}  // namespace dem::midpoint
