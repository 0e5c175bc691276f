// Derivatives of every scattering model with respect to its parameters: dual numbers against finite differences, the
// thread's closed forms against dual numbers.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "renderer/scattering/fiber.h"
#include "renderer/scattering/thread.h"
#include "renderer/scattering/thread_gradient.h"
#include "renderer/scattering/yarn.h"
#include "tests/renderer/scattering/finite_differences.h"
#include "tests/renderer/scattering/scattering_statistics.h"

namespace renderer {
namespace {

struct Place {
  Vec3<double> wo, wi;
  double theta_o, h;
};

template <class S>
using Outcome = Eigen::Array<S, 4, 1>;  // f_cos, density

// What the tests below run over: the differentiable parameters of each model and how to make it of them.
struct Fibers {
  static constexpr std::size_t kCount = 7;
  using Values = std::array<double, kCount>;
  template <class S>
  static FiberModel<S> model(const std::array<S, kCount>& p) {
    return FiberModel<S>(BasicFiberParameters<S>{
        .eta = p[0], .sigma_a = {p[1], p[2], p[3]}, .beta_m = p[4], .beta_n = p[5], .tilt_rad = p[6]});
  }
  static Values values(double along, double across) { return {1.55, 0.1, 0.3, 0.8, along, across, 0.02}; }
};

template <bool limited, bool with_options>
struct Threads {
  static constexpr std::size_t kCount = kThreadParameterCount;
  using Values = std::array<double, kCount>;
  template <class S>
  static BasicThreadParameters<S> parameters(const std::array<S, kCount>& p) {
    BasicThreadParameters<S> parameters = thread_parameters(p, limited);
    if (with_options) {
      parameters.lambda0_rgb = {S(1.0), S(0.7), S(0.2)};
      parameters.transmittance_powers = {1.5, 2};
    }
    return parameters;
  }
  template <class S>
  static ThreadModel<S> model(const std::array<S, kCount>& p) {
    return ThreadModel<S>(parameters(p));
  }
  static Values values(double along, double across) {
    const double r0c = limited ? 0.9 : 0.58, r1a = limited ? 0.9 : 0.66;  // the limit is active everywhere
    return {0.1, 0.3,  0.8, along, along / 2 + 0.01, along, across, across, across / 2 + 0.01, -0.44, 0.16, r0c,
            r1a, 15.6, 2.0, -0.03};
  }
};
using UnlimitedThreads = Threads<false, false>;
using LimitedThreads = Threads<true, false>;
using MetallicThreads = Threads<false, true>;

struct Yarns {
  static constexpr std::size_t kCount = 7;
  using Values = std::array<double, kCount>;
  template <class S>
  static YarnModel<S> model(const std::array<S, kCount>& p) {
    return YarnModel<S>(BasicYarnParameters<S>{.fiber_count = 30,
                                               .radius_ratio = 0.12,
                                               .eta = p[0],
                                               .sigma_a = {p[1], p[2], p[3]},
                                               .beta_r = p[4],
                                               .beta_tt = p[5],
                                               .gamma_tt = p[6]});
  }
  static Values values(double along, double across) { return {1.55, 0.3, 0.9, 2.4, along, along, across}; }
};

template <std::size_t count>
auto jets(const std::array<double, count>& values) {
  std::array<ceres::Jet<double, static_cast<int>(count)>, count> out;
  for (std::size_t k = 0; k < count; ++k) out[k] = {values[k], static_cast<int>(k)};
  return out;
}

template <class Family, class S>
Outcome<S> outcome(const std::array<S, Family::kCount>& parameters, const Place& at) {
  const auto model = Family::model(parameters);
  const ScatteringValue<S> value = model.lobes_at(at.h, at.wo).evaluate(at.wi);
  return {value.f_cos[0], value.f_cos[1], value.f_cos[2], value.pdf};
}

// Calls judge(values, place): all roughnesses, inclinations and offsets, near the specular cone and off it.
template <class Family, class Judge>
void everywhere(const Judge& judge) {
  for (double along : {0.02, 0.1, 0.3, 0.6, 1.0})
    for (double across : {0.02, 0.2, 0.5, 1.0})
      for (double theta_o : {-1.484, -0.6, 0.0, 0.5, 1.484})  // 85 degrees
        for (double h : {-0.99, 0.05, 0.8})
          for (double off_cone : {0.005, 0.05, 0.6})
            for (double phi : {-3.0, -1.2, 0.3, 2.0}) {
              const double theta_i = -theta_o + (theta_o > 0 ? off_cone : -off_cone);
              judge(Family::values(along, across),
                    Place{viewing_direction(theta_o, h), direction(theta_i, phi), theta_o, h});
            }
}

template <class Family>
class ScatteringDerivativesTest : public testing::Test {};
using Families = testing::Types<Fibers, UnlimitedThreads, LimitedThreads, MetallicThreads, Yarns>;
TYPED_TEST_SUITE(ScatteringDerivativesTest, Families);

TYPED_TEST(ScatteringDerivativesTest, DualNumbersAgreeWithFiniteDifferences) {
  everywhere<TypeParam>([](const auto& values, const Place& at) {
    const auto dual = outcome<TypeParam>(jets(values), at);
    for (std::size_t k = 0; k < TypeParam::kCount; ++k) {
      const Outcome<double> expected =
          finite_difference([&](const auto& moved) { return outcome<TypeParam>(moved, at); }, values, k);
      for (int c = 0; c < 4; ++c) {
        if (dual[c].a < 1e-30) continue;  // so far down a lobe's tail that differences see nothing
        EXPECT_NEAR(dual[c].v[static_cast<int>(k)], expected[c], 1e-5 * (std::abs(expected[c]) + dual[c].a))
            << "parameter " << k << ", component " << c;
      }
    }
  });
}

TYPED_TEST(ScatteringDerivativesTest, ValuesOfDualNumbersAreThoseOfNumbers) {
  everywhere<TypeParam>([](const auto& values, const Place& at) {
    const auto dual = outcome<TypeParam>(jets(values), at);
    const Outcome<double> plain = outcome<TypeParam>(values, at);
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(dual[c].a, plain[c], 1e-13 * plain[c] + 1e-300);
  });
}

TYPED_TEST(ScatteringDerivativesTest, DerivativesAreFiniteAtGrazingOffsetsAndAlongTheCurve) {
  for (double roughness : {0.02, 1.0}) {
    for (double sigma : {0.0, 1000.0}) {
      auto values = TypeParam::values(roughness, roughness);
      const std::size_t first = TypeParam::kCount == kThreadParameterCount ? 0 : 1;  // sigma_a
      for (std::size_t k = first; k < first + 3; ++k) values[k] = sigma;
      for (double h : {-1.0, 0.0, 1.0})
        for (double theta : {-std::numbers::pi / 2, 0.0, 1.5707, std::numbers::pi / 2})
          for (double phi : {-std::numbers::pi, 0.0, 1.0}) {
            const Place at{viewing_direction(theta, h), direction(-theta, phi), theta, h};
            const auto dual = outcome<TypeParam>(jets(values), at);
            for (int c = 0; c < 4; ++c) EXPECT_TRUE(std::isfinite(dual[c].a) && dual[c].v.allFinite());
          }
    }
  }
}

using Values = UnlimitedThreads::Values;

// All derivatives of one channel in the order of Values; the two other channels' absorptions give none.
Values slopes_of(const ThreadGradient<double>& gradient, int channel) {
  Values slopes{};
  slopes[static_cast<std::size_t>(channel)] = gradient.slopes(kSlopeSigma, channel);
  for (int k = 1; k < kSlopeTint; ++k) slopes[static_cast<std::size_t>(k + 2)] = gradient.slopes(k, channel);
  return slopes;
}

template <class S>
ThreadPoint<S> point_of(const Place& at) {
  const InnerChord<double> chord(at.h, std::sin(at.theta_o), std::cos(at.theta_o), kThreadEta);
  return {static_cast<S>(std::cos(at.theta_o)), static_cast<S>(chord.length)};
}

LobeAngles<double> angles_at(const Values& values, const Place& at) {
  return UnlimitedThreads::model(values).lobes_at(at.h, at.wo).angles(at.wi);
}

template <class Family>
class ThreadGradientTest : public testing::Test {};
using GradientFamilies = testing::Types<UnlimitedThreads, MetallicThreads>;
TYPED_TEST_SUITE(ThreadGradientTest, GradientFamilies);

TYPED_TEST(ThreadGradientTest, ClosedFormDerivativesAreThoseOfDualNumbers) {
  everywhere<TypeParam>([](const Values& values, const Place& at) {
    const auto expected = outcome<TypeParam>(jets(values), at);
    const ThreadGradientModel<double> model(TypeParam::parameters(values));
    const auto point = point_of<double>(at);
    const auto angles = angles_at(values, at);
    const auto found = model.evaluate(point, angles);
    const auto value_alone = model.f_cos(point, angles);
    for (int c = 0; c < 3; ++c) {
      const auto& jet = expected[c];
      EXPECT_NEAR(found.f_cos[c], jet.a, 1e-12 * jet.a + 1e-300);
      EXPECT_NEAR(value_alone[c], jet.a, 1e-12 * jet.a + 1e-300);
      const Values slopes = slopes_of(found, c);
      for (std::size_t k = 0; k < slopes.size(); ++k) {
        const double slope = jet.v[static_cast<int>(k)];
        EXPECT_NEAR(slopes[k], slope, 1e-10 * (jet.a + std::abs(slope)) + 1e-290) << "parameter " << k;
      }
    }
  });
}

TEST(ThreadGradientTest, TheSlopeByTheTintIsThatOfFiniteDifferences) {
  everywhere<MetallicThreads>([](const Values& values, const Place& at) {
    constexpr double kStep = 0.01;  // f_cos is linear in the tint
    ThreadParameters parameters = MetallicThreads::parameters(values);
    const auto point = point_of<double>(at);
    const auto angles = angles_at(values, at);
    const auto found = ThreadGradientModel<double>(parameters).evaluate(point, angles);
    parameters.lambda0_rgb.array() += kStep;
    const Rgb<double> beside = ThreadGradientModel<double>(parameters).f_cos(point, angles);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found.slopes(kSlopeTint, c), (beside[c] - found.f_cos[c]) / kStep, 1e-10 * beside[c] + 1e-290);
  });
}

TYPED_TEST(ThreadGradientTest, ClosedFormDerivativesInFloatLoseNoMoreThanFloats) {
  everywhere<TypeParam>([](const Values& values, const Place& at) {
    const ThreadParameters parameters = TypeParam::parameters(values);
    const LobeAngles<double> angles = angles_at(values, at);
    const LobeAngles<float> angles_in_float{angles.distance2.cast<float>(), angles.cos_cos.cast<float>(),
                                            angles.from_center.cast<float>()};
    const auto expected = ThreadGradientModel<double>(parameters).evaluate(point_of<double>(at), angles);
    const ThreadGradientModel<float> model(in_scalar<float>(parameters));
    const auto found = model.evaluate(point_of<float>(at), angles_in_float);
    const ThreadPoint<float> point = point_of<float>(at);
    const auto packets = ThreadGradientModel<Packet<4>>(model).evaluate(
        {Packet<4>(point.cosine), Packet<4>(point.chord_length)},
        {lanes_in<Packet<4>, float>(angles_in_float.distance2), lanes_in<Packet<4>, float>(angles_in_float.cos_cos),
         lanes_in<Packet<4>, float>(angles_in_float.from_center)});
    for (int k = 0; k < kThreadSlopeCount; ++k) {
      const double slope = expected.slopes(k, 1);
      // exp of arguments up to 70 in float is good to 1e-5, and terms of the size f / roughness cancel beside it
      const double tolerance = 1e-4 * (std::abs(slope) + expected.f_cos[1]) + 1e-20;
      EXPECT_NEAR(static_cast<double>(found.slopes(k, 1)), slope, tolerance) << "parameter " << k;
      EXPECT_NEAR(static_cast<double>(packets.slopes(k, 1)[3]), slope, tolerance) << "parameter " << k;
    }
  });
}

}  // namespace
}  // namespace renderer
