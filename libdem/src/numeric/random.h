#pragma once
// Random numbers without state: a hash of (seed, stream, col, row). Order, threads and tiles
// cannot change them, and integer arithmetic makes them the same on every machine.

#include <cstdint>

namespace dem::numeric {

/// A 64-bit mixer: each output bit depends on each input bit (finaliser by xor-shift-multiply).
constexpr std::uint64_t mix(std::uint64_t x) {
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93ULL;
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93ULL;
  x ^= x >> 32;
  return x;
}

/// 64 random bits for one cell; `stream` tells apart the uses of one seed.
constexpr std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, int col, int row) {
  const std::uint64_t cell =
      (std::uint64_t(std::uint32_t(row)) << 32) | std::uint64_t(std::uint32_t(col));
  return mix(mix(mix(seed + 0x9e3779b97f4a7c15ULL) ^ (stream * 0xbf58476d1ce4e5b9ULL)) ^
             (cell + 0x94d049bb133111ebULL));
}

/// Uniform in [-1, 1): 53 bits.
constexpr double signed_uniform(std::uint64_t bits) {
  return double(std::int64_t(bits) >> 11) * (1.0 / 4503599627370496.0);
}

/// Uniform integer in [0, bound), bound > 0.
constexpr std::uint64_t below(std::uint64_t bits, std::uint64_t bound) {
  __extension__ using Wide = unsigned __int128;
  return std::uint64_t((Wide(bits) * bound) >> 64);
}

/// A sequence of random numbers for code that draws one after another.
class Sequence {
 public:
  explicit Sequence(std::uint64_t seed, std::uint64_t stream = 0) : seed_(seed), stream_(stream) {}
  std::uint64_t bits() {
    ++count_;
    return random_bits(seed_, stream_, int(count_ & 0x7fffffff), int(count_ >> 31));
  }
  std::uint64_t below(std::uint64_t bound) { return numeric::below(bits(), bound); }

 private:
  std::uint64_t seed_, stream_, count_ = 0;
};

}  // namespace dem::numeric
