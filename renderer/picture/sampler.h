// The random numbers of one pixel: Owen-scrambled Sobol' points in pairs of dimensions for the first dimensions of a
// path, hashed random numbers after that. They depend on seed, pixel, sample and dimension only.
//
// Source: Burley 2020, "Practical Hash-based Owen Scrambling" (JCGT 9(4)): scrambling constants and index shuffling.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "renderer/scattering/random_stream.h"

namespace renderer {

class Sampler {
 public:
  Sampler(std::uint64_t seed, std::uint64_t pixel) : pixel_key_(mixed_bits(seed + mixed_bits(pixel + 1))) {}

  void start_sample(std::uint32_t index) {
    index_ = index;
    dimension_ = 0;
  }

  Eigen::Vector2f next_2d() {
    const std::uint64_t key = mixed_bits(pixel_key_ + 0x9e3779b97f4a7c15u * ++dimension_);
    const auto low = static_cast<std::uint32_t>(key), high = static_cast<std::uint32_t>(key >> 32);
    if (dimension_ > kSobolDimensions) {
      const std::uint64_t random = mixed_bits(key + index_);
      return {to_unit(static_cast<std::uint32_t>(random)), to_unit(static_cast<std::uint32_t>(random >> 32))};
    }
    const std::uint32_t shuffled = reversed(scrambled(reversed(index_), low ^ high));
    return {to_unit(reversed(scrambled(shuffled, low))), to_unit(reversed(scrambled(pascal(shuffled), high)))};
  }
  float next_1d() { return next_2d().x(); }

 private:
  static constexpr std::uint64_t kSobolDimensions = 16;

  static float to_unit(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

  static std::uint32_t reversed(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  }

  // Each bit changes as a random function of the bits below it: an Owen scrambling of the reversed number.
  static std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    return x ^ (x * 0x8d22f6e6u);
  }

  // The second Sobol' dimension (bits reversed): Pascal's triangle modulo 2 applied to the index. Binomial(n, k) is
  // odd exactly when the bits of k are a subset of those of n, so five steps of a butterfly do it.
  static std::uint32_t pascal(std::uint32_t x) {
    x ^= (x & 0xaaaaaaaau) >> 1;
    x ^= (x & 0xccccccccu) >> 2;
    x ^= (x & 0xf0f0f0f0u) >> 4;
    x ^= (x & 0xff00ff00u) >> 8;
    return x ^ ((x & 0xffff0000u) >> 16);
  }

  std::uint64_t pixel_key_;
  std::uint32_t index_ = 0;
  std::uint64_t dimension_ = 0;
};

}  // namespace renderer
