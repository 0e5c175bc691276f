// A stream of random numbers that its seed and number determine completely: SplitMix64 (Steele et al. 2014), which
// needs one multiplication chain per number and 8 bytes of state, so that thousands of streams cost nothing.
#pragma once

#include <cstdint>

namespace renderer {

// A bijection of 64 bits whose output looks random (SplitMix64's finaliser).
constexpr std::uint64_t mixed_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

class RandomStream {
 public:
  // Streams with the same seed and different numbers are independent.
  RandomStream(std::uint64_t seed, std::uint64_t stream) : state_(mixed_bits(seed + mixed_bits(stream + 1))) {}

  double uniform() {  // in [0, 1)
    state_ += 0x9e3779b97f4a7c15u;
    return static_cast<double>(mixed_bits(state_) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

}  // namespace renderer
