#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "renderer/scattering/fiber.h"

namespace renderer {
namespace {

constexpr int kParameters = 7;
using Jet = ceres::Jet<double, kParameters>;
using Values = std::array<double, kParameters>;  // eta, sigma_a, beta_m, beta_n, tilt

struct Geometry {
  double theta_o, h, theta_i, phi_i;
};

template <class S>
ScatteringValue<S> evaluate(const std::array<S, kParameters>& p, const Geometry& g) {
  const FiberModel<S> model(BasicFiberParameters<S>{
      .eta = p[0], .sigma_a = {p[1], p[2], p[3]}, .beta_m = p[4], .beta_n = p[5], .tilt_rad = p[6]});
  const auto direction = [](double theta, double phi) {
    return Vec3<double>(std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi));
  };
  return model.lobes_at(g.h, direction(g.theta_o, kPi / 2 + std::asin(g.h))).evaluate(direction(g.theta_i, g.phi_i));
}

TEST(FiberDerivativeTest, DualNumbersAgreeWithFiniteDifferences) {
  const Values values{1.55, 0.1, 0.3, 0.8, 0.3, 0.25, 0.02};
  for (const Geometry& g :
       {Geometry{0.2, 0.3, -0.4, 1.0}, Geometry{-0.9, -0.8, 0.7, -2.0}, Geometry{0, 0.05, 0.1, -1.4}}) {
    std::array<Jet, kParameters> jets;
    for (int k = 0; k < kParameters; ++k)
      jets[static_cast<std::size_t>(k)] = Jet(values[static_cast<std::size_t>(k)], k);
    const auto dual = evaluate(jets, g);
    const auto plain = evaluate(values, g);
    for (int k = 0; k < kParameters; ++k) {
      Values above = values, below = values;
      constexpr double kStep = 1e-5;  // balances the step's cube and rounding
      above[static_cast<std::size_t>(k)] += kStep, below[static_cast<std::size_t>(k)] -= kStep;
      const auto high = evaluate(above, g), low = evaluate(below, g);
      for (int c = 0; c < 3; ++c) {
        EXPECT_DOUBLE_EQ(dual.f_cos[c].a, plain.f_cos[c]);
        const double expected = (high.f_cos[c] - low.f_cos[c]) / (2 * kStep);
        EXPECT_NEAR(dual.f_cos[c].v[k], expected, 1e-6 * (std::abs(expected) + plain.f_cos[c])) << k << ' ' << c;
      }
      const double expected = (high.pdf - low.pdf) / (2 * kStep);
      EXPECT_NEAR(dual.pdf.v[k], expected, 1e-6 * (std::abs(expected) + plain.pdf)) << k;
    }
  }
}

TEST(FiberDerivativeTest, DerivativesAreFiniteAtGrazingOffsetsAndAlongTheFiber) {
  std::array<Jet, kParameters> jets;
  const Values values{1.55, 0, 0, 0, 0.02, 0.02, 0};
  for (int k = 0; k < kParameters; ++k)
    jets[static_cast<std::size_t>(k)] = Jet(values[static_cast<std::size_t>(k)], k);
  for (const Geometry& g : {Geometry{0.2, 1, -0.4, 1.0}, Geometry{kPi / 2, 0.5, 0, 0}, Geometry{0, -1, kPi / 2, 0}}) {
    const auto value = evaluate(jets, g);
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(value.f_cos[c].v.allFinite());
    EXPECT_TRUE(value.pdf.v.allFinite());
  }
}

}  // namespace
}  // namespace renderer
