// Offsets at which light leaves bundles of fibers: laws that hold without a simulation, and how far one table serves
// all threads.
#include "renderer/scattering/exit_offsets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "renderer/scattering/multi_fiber.h"

namespace renderer {
namespace {

constexpr int kOffsets = 8, kAzimuths = 12;

std::vector<double> exits_of(double radius_ratio, double eta, double gap, double theta_rad, std::uint64_t seed,
                             int configurations = 100) {
  MultiFiberOptions options = simulation_of({radius_ratio, eta, gap, {}}, 0, theta_rad);
  options.rays = 4000, options.configurations = configurations, options.seed = seed;
  options.bins = kAzimuths, options.offset_bins = kOffsets;
  return simulate_multi_fiber(options).exits;
}

double at(const std::vector<double>& exits, int in, int azimuth, int out) {
  return exits[static_cast<std::size_t>((in * kAzimuths + azimuth) * kOffsets + out)];
}

// A single fiber as thick as the thread turns light about its own axis, so that every ray keeps its offset.
TEST(ExitOffsetsTest, OneRoundFiberKeepsTheOffset) {
  MultiFiberOptions options{.thread_radius = 1, .fiber_radius = 1, .rays = 4000, .configurations = 2};
  options.bins = kAzimuths, options.offset_bins = kOffsets;
  const std::vector<double> exits = simulate_multi_fiber(options).exits;
  double kept = 0, all = 0;
  for (int in = 0; in < kOffsets; ++in)
    for (int azimuth = 0; azimuth < kAzimuths; ++azimuth)
      for (int out = 0; out < kOffsets; ++out) {
        all += at(exits, in, azimuth, out);
        if (out == kOffsets / 2 + in / 2) kept += at(exits, in, azimuth, out);  // bins out are twice as wide
      }
  EXPECT_NEAR(all, 1, 1e-9);
  EXPECT_NEAR(kept, 1, 1e-9);
}

// Light that goes the other way has the same ways: what comes in at a and leaves at b by an azimuth also comes in at b
// and leaves at a by that azimuth (its mirror image does).
TEST(ExitOffsetsTest, WaysCanBeGoneBackwards) {
  constexpr int kHalf = kOffsets / 2;
  const std::vector<double> exits = exits_of(0.2, 1.5, 0.1, 0, 1, 800);
  const auto between = [&](int in, int azimuth, int out) {  // bins of |offset| twice as wide, both of one sign
    return at(exits, 2 * in, azimuth, kHalf + out) + at(exits, 2 * in + 1, azimuth, kHalf + out);
  };
  double difference = 0, sum = 0;
  for (int azimuth = 0; azimuth < kAzimuths; ++azimuth)
    for (int a = 0; a < kHalf; ++a)
      for (int b = 0; b < a; ++b) {
        difference += std::abs(between(a, azimuth, b) - between(b, azimuth, a));
        sum += between(a, azimuth, b) + between(b, azimuth, a);
      }
  std::printf("one way and back differ by %.4f of the light\n", difference / sum);
  EXPECT_LT(difference / sum, 0.05);  // of 3,200,000 rays
}

TEST(ExitOffsetsTest, SamplesHaveTheirDensityAndMirrorImages) {
  const ExitOffsets& table = simulated_exit_offsets();
  for (const float in : {-0.9f, -0.3f, 0.0f, 0.55f})
    for (const float azimuth : {-2.9f, -0.4f, 1.3f, 3.1f}) {
      constexpr int kDraws = 1024;
      double mean = 0, expected = 0;
      for (int i = 0; i < kDraws; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / kDraws, offset = 2 * u - 1;
        mean += static_cast<double>(table.sample(in, azimuth, u)) / kDraws;
        expected += static_cast<double>(offset * table.density(in, azimuth, offset)) * 2 / kDraws;
        if (in != 0) EXPECT_EQ(table.sample(-in, -azimuth, u), -table.sample(in, azimuth, u));
      }
      EXPECT_NEAR(mean, expected, 2e-3);
    }
  EXPECT_EQ(table.density(0.2f, 1, 1.01f), 0);
}

// The table against threads that are not in its library, by the offsets' means, beside the two rules without a table.
TEST(ExitOffsetsTest, OneTableServesThreadsOfFewAndManyFibers) {
  const ExitOffsets& table = simulated_exit_offsets();
  struct Thread {
    double radius_ratio, eta, gap, theta_rad;
  };
  for (const Thread& of : {Thread{0.07, 1.55, 0.1, 0.0}, Thread{0.15, 1.5, 0.02, 0.4}, Thread{0.2, 1.55, 0.02, 0.2}}) {
    const std::vector<double> exits = exits_of(of.radius_ratio, of.eta, of.gap, of.theta_rad, 7);
    double energy = 0, by_table = 0, anywhere = 0, straight = 0;
    for (int in = 0; in < kOffsets; ++in)
      for (int azimuth = 0; azimuth < kAzimuths; ++azimuth) {
        double row = 0, mean = 0, expected = 0;
        for (int out = 0; out < kOffsets; ++out) {
          row += at(exits, in, azimuth, out);
          mean += at(exits, in, azimuth, out) * ((out + 0.5) / kOffsets * 2 - 1);
        }
        if (row == 0) continue;
        mean /= row;
        const double offset_in = (in + 0.5) / kOffsets, phi = ((azimuth + 0.5) / kAzimuths * 2 - 1) * std::numbers::pi;
        constexpr int kPoints = 64;
        for (int i = 0; i < kPoints; ++i)
          expected += static_cast<double>(table.sample(static_cast<float>(offset_in), static_cast<float>(phi),
                                                       (static_cast<float>(i) + 0.5f) / kPoints)) /
                      kPoints;
        const double entry = -std::sin(std::asin(offset_in) + phi);  // the offset of what leaves there
        energy += row;
        by_table += row * std::abs(mean - expected);
        anywhere += row * std::abs(mean);
        straight += row * std::abs(mean - entry);
      }
    std::printf("fibers of %.2f radii, index %.2f: mean offset off by %.3f (table), %.3f (anywhere), %.3f (entry)\n",
                of.radius_ratio, of.eta, by_table / energy, anywhere / energy, straight / energy);
    EXPECT_LT(by_table / energy, 0.1);
    EXPECT_GT(anywhere / energy, 2 * by_table / energy);
    EXPECT_GT(straight / energy, 2 * by_table / energy);
  }
}

}  // namespace
}  // namespace renderer
