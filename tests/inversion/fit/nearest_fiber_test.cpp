#include "inversion/fit/nearest_fiber.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

namespace inversion {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;
using renderer::FiberParameters;
using renderer::ThreadParameters;

ThreadParameters coloured_thread() {
  return {.sigma_a = {0.06, 1.3, 0.7}, .alpha = {0.16, 0.2, 0.22}, .beta = {0.5, 0.55, 0.3}};
}

// Over h, sin theta_o and the sphere of directions i in even steps; weights as nearest_fiber.h says.
FiberAgreement agreement_by_even_steps(const FiberParameters& fiber_parameters, const ThreadParameters& parameters) {
  constexpr int kOffsets = 16, kInclinations = 10, kHeights = 160, kTurns = 120;
  const renderer::FiberModel<double> fiber(fiber_parameters);
  const renderer::ThreadModel<double> thread(parameters);
  double difference = 0, whole = 0, difference_far = 0, whole_far = 0, weights = 0;
  FiberAgreement found;
  for (int s = 0; s < kInclinations; ++s) {
    const double sine = (s + 0.5) / kInclinations, cosine = std::sqrt(1 - sine * sine);
    const Vector3d wo(sine, cosine, 0);
    weights += cosine;
    for (int a = 0; a < kHeights; ++a)
      for (int b = 0; b < kTurns; ++b) {
        const double x = -1 + 2 * (a + 0.5) / kHeights, phi = 2 * std::numbers::pi * (b + 0.5) / kTurns;
        const Vector3d wi(x, std::sqrt(1 - x * x) * std::cos(phi), std::sqrt(1 - x * x) * std::sin(phi));
        Array3d of_fiber = Array3d::Zero(), of_thread = Array3d::Zero();
        for (int k = 0; k < kOffsets; ++k) {
          const double h = -1 + 2 * (k + 0.5) / kOffsets;
          const Array3d f = fiber.lobes_at(h, wo).evaluate(wi).f_cos, t = thread.lobes_at(h, wo).evaluate(wi).f_cos;
          difference += cosine * (f - t).square().sum() / kOffsets;
          whole += cosine * t.square().sum() / kOffsets;
          of_fiber += f / kOffsets, of_thread += t / kOffsets;
        }
        difference_far += cosine * (of_fiber - of_thread).square().sum();
        whole_far += cosine * of_thread.square().sum();
        if (wi.y() > 0) {
          found.fiber_back += cosine * of_fiber * 4 * std::numbers::pi / (kHeights * kTurns);
          found.thread_back += cosine * of_thread * 4 * std::numbers::pi / (kHeights * kTurns);
        }
        found.fiber_albedo += cosine * of_fiber * 4 * std::numbers::pi / (kHeights * kTurns);
        found.thread_albedo += cosine * of_thread * 4 * std::numbers::pi / (kHeights * kTurns);
      }
  }
  found.rms = std::sqrt(difference / whole), found.rms_far = std::sqrt(difference_far / whole_far);
  for (Array3d* mean : {&found.fiber_albedo, &found.thread_albedo, &found.fiber_back, &found.thread_back})
    *mean /= weights;
  return found;
}

TEST(NearestFiberTest, ErrorsAreThoseOfEvenSteps) {
  const ThreadParameters thread = coloured_thread();
  const FiberParameters fiber{.sigma_a = {0.1, 0.5, 0.4}, .beta_m = 0.25, .beta_n = 0.4};
  const FiberAgreement found = fiber_agreement(fiber, thread), expected = agreement_by_even_steps(fiber, thread);
  EXPECT_NEAR(found.rms, expected.rms, 0.03 * expected.rms);  // thousands of directions, drawn
  EXPECT_NEAR(found.rms_far, expected.rms_far, 0.03 * expected.rms_far);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(found.fiber_albedo[c], expected.fiber_albedo[c], 5e-3);  // steps of h near the rim
    EXPECT_NEAR(found.thread_albedo[c], expected.thread_albedo[c], 5e-3);
    EXPECT_NEAR(found.fiber_back[c], expected.fiber_back[c], 5e-3);
    EXPECT_NEAR(found.thread_back[c], expected.thread_back[c], 5e-3);
  }
}

TEST(NearestFiberTest, KeepsBrightnessAndColour) {
  const NearestFiber nearest = nearest_fiber(coloured_thread());
  EXPECT_TRUE(nearest.converged);
  const FiberAgreement& found = nearest.agreement;
  std::printf("error %.3f, from afar %.3f\n", found.rms, found.rms_far);
  // The fit weighs all channels together, and both energies alike.
  for (int c = 0; c < 3; ++c) {
    std::printf("albedo %.4f %.4f, back %.4f %.4f\n", found.fiber_albedo[c], found.thread_albedo[c],
                found.fiber_back[c], found.thread_back[c]);
    EXPECT_NEAR(found.fiber_albedo[c], found.thread_albedo[c], 0.03 * found.thread_albedo[c]);
    // Of the dark channels a fiber's surface alone sends light back: 21 % less than this thread.
    EXPECT_NEAR(found.fiber_back[c], found.thread_back[c], 0.25 * found.thread_back[c]);
  }
  EXPECT_GT(found.rms, 0.2);  // three lobes of widths of their own: no fiber has them, and it is said
}

// What is fitted, but for the albedos' spread over directions: their means stand for them.
double loss(const FiberAgreement& found) {
  const double albedo = (found.fiber_albedo - found.thread_albedo).square().sum() / found.thread_albedo.square().sum(),
               back = (found.fiber_back - found.thread_back).square().sum() / found.thread_albedo.square().sum();
  return found.rms * found.rms + 100 * (albedo + back);
}

TEST(NearestFiberTest, OtherFibersAreFartherFromTheThread) {
  const ThreadParameters thread = coloured_thread();
  const NearestFiber nearest = nearest_fiber(thread);
  const double least = loss(nearest.agreement);
  for (const double factor : {0.7, 1.4}) {
    for (double FiberParameters::*roughness : {&FiberParameters::beta_m, &FiberParameters::beta_n}) {
      FiberParameters other = nearest.fiber;
      other.*roughness = std::min(1.0, other.*roughness * factor);
      EXPECT_GT(loss(fiber_agreement(other, thread)), least) << factor;
    }
    FiberParameters other = nearest.fiber;
    other.sigma_a *= factor;
    EXPECT_GT(loss(fiber_agreement(other, thread)), least) << factor;
  }
}

TEST(NearestFiberTest, ChannelsChangePlacesWithTheColours) {
  Eigen::Matrix3d swapped;
  swapped << 0, 0, 1, 0, 1, 0, 1, 0, 0;
  const NearestFiber plain = nearest_fiber(coloured_thread()), turned = nearest_fiber(coloured_thread(), swapped);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(turned.fiber.sigma_a[c], plain.fiber.sigma_a[2 - c], 2e-3);
  EXPECT_NEAR(turned.agreement.rms, plain.agreement.rms, 1e-3);
}

TEST(NearestFiberTest, AThreadWithoutLightIsRefused) {
  const ThreadParameters black{.r0a = 0, .r0b = 0, .r0c = 0, .r1a = 0, .r2a = 0, .r2b = 1, .r2c = -1};
  EXPECT_THROW(nearest_fiber(black), std::runtime_error);
}

}  // namespace
}  // namespace inversion
