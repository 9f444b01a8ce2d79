// Counter-based random numbers: the same (seed, stream, counter) gives the same number anywhere.
#pragma once

#include <cstdint>

namespace rend {

/// Mixes 64 bits so that neighbouring inputs give unrelated outputs (splitmix64 finaliser).
constexpr std::uint64_t mix_bits(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

/// A stateless sequence: value n of a stream depends on nothing but (seed, stream, n).
class Random {
 public:
  constexpr Random(std::uint64_t seed, std::uint64_t stream)
      : key_(mix_bits(seed) ^ mix_bits(~stream)) {}

  constexpr std::uint64_t bits(std::uint64_t n) const { return mix_bits(key_ + mix_bits(n)); }

  /// Uniform in [0, 1).
  constexpr double uniform(std::uint64_t n) const { return static_cast<double>(bits(n) >> 11) * 0x1p-53; }
  /// Next value of the stream; advances the internal counter.
  constexpr double next() { return uniform(counter_++); }
  constexpr double next(double low, double high) { return low + (high - low) * next(); }

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace rend
