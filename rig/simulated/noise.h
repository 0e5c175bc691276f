// The random numbers of the simulated bench: the same on every machine for the same seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>

namespace rig {

// SplitMix64's mixing step (Steele, Lea, Flood 2014).
inline std::uint64_t mixed(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

class NoiseStream {
 public:
  NoiseStream(std::uint64_t seed, std::uint64_t stream) : state_(mixed(seed + mixed(stream + kStep))) {}

  // A uniform number in (0, 1); never 0, so that its logarithm exists.
  double uniform() {
    state_ += kStep;
    return (static_cast<double>(mixed(state_) >> 12) + 0.5) * 0x1p-52;
  }

  // Two independent standard normal numbers: Box and Muller's (1958) by Marsaglia's polar method (1964).
  std::pair<double, double> normals() {
    double x = 0, y = 0, square = 0;
    do {
      x = 2 * uniform() - 1;
      y = 2 * uniform() - 1;
      square = x * x + y * y;
    } while (square >= 1 || square == 0);
    const double stretch = std::sqrt(-2 * std::log(square) / square);
    return {x * stretch, y * stretch};
  }

  // A Poisson number by inversion. For means below about 100: it takes as many steps as the answer, and exp(-mean) must
  // not vanish.
  double small_poisson(double mean) {
    const double target = uniform();
    double probability = std::exp(-mean), reached = probability, count = 0;
    while (reached < target && probability > 0) {
      count += 1;
      probability *= mean / count;
      reached += probability;
    }
    return count;
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;
  std::uint64_t state_;
};

}  // namespace rig
