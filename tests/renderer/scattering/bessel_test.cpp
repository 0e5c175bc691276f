#include "renderer/scattering/bessel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace renderer {
namespace {

constexpr double kArguments[] = {0.0, 0.1, 1.0, 3.7, 3.76, 8.0, 11.8, 12.1, 19.9, 20.1, 60.0, 500.0};

double single(double x) {
  return static_cast<double>(bessel_i0e(Packet<4>(x)).value()[0]);
}

double single_slope(double x) {
  return static_cast<double>(bessel_i0e_log_slope(Packet<4>(x))[0]);
}

TEST(BesselTest, ScaledFunctionAgreesWithTheStandardLibrary) {
  for (double x : kArguments) {
    const double expected = std::cyl_bessel_i(0.0, x) * std::exp(-x);
    EXPECT_NEAR(bessel_i0e(x).value() / expected, 1, 1e-13) << x;  // rounding of some hundred operations
    EXPECT_NEAR(single(x) / expected, 1, 1e-6) << x;               // the polynomials' own error is 4e-7
  }
}

TEST(BesselTest, SlopeOfTheLogarithmIsThatOfI1OverI0) {
  for (double x : kArguments) {
    const double expected = x * (std::cyl_bessel_i(1.0, x) / std::cyl_bessel_i(0.0, x) - 1);
    EXPECT_NEAR(bessel_i0e_log_slope(x), expected, 1e-13 * (1 + x)) << x;
    EXPECT_NEAR(single_slope(x), expected, 2e-6) << x;
  }
}

TEST(BesselTest, SinglePrecisionFollowsDoublePrecisionEverywhere) {
  for (double x = 0; x < 1e4; x = 1.01 * x + 0.003) {
    const double rounded = static_cast<double>(static_cast<float>(x));
    EXPECT_NEAR(single(rounded) / bessel_i0e(rounded).value(), 1, 1e-6) << x;
    EXPECT_NEAR(single_slope(rounded), bessel_i0e_log_slope(rounded), 2e-6) << x;
  }
}

TEST(BesselTest, LanesOfFloatsAreOnePacket) {
  const Eigen::Array4f x(0.3f, 3.0f, 5.0f, 4000.0f);
  const auto lanes = bessel_i0e(x);
  const Eigen::Array4f value = lanes.factor * (-lanes.exponent).exp(), slope = bessel_i0e_log_slope(x);
  for (int i = 0; i < 4; ++i) {
    const auto at = static_cast<double>(x[i]);
    EXPECT_NEAR(static_cast<double>(value[i]) / bessel_i0e(at).value(), 1, 1e-6) << at;
    EXPECT_NEAR(static_cast<double>(slope[i]), bessel_i0e_log_slope(at), 2e-6) << at;
  }
}

}  // namespace
}  // namespace renderer
