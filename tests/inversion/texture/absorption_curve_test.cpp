#include "inversion/texture/absorption_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace inversion {
namespace {

double law(double sigma_a) {
  return 0.05 + 0.8 * std::exp(-1.3 * sigma_a);
}

AbsorptionCurve measured() {
  return measure_absorption_curves([](double s) { return Eigen::Array3d(0.5 * law(s), law(s), 0.9 * law(s)); }, 24)[1];
}

TEST(AbsorptionCurve, FollowsTheLawThatItWasMeasuredFromAndInvertsIt) {
  const AbsorptionCurve curve = measured();
  for (const double sigma_a : {0.0, 0.02, 0.1, 0.5, 1.0, 2.0}) {
    EXPECT_NEAR(curve.reflectance(sigma_a), law(sigma_a), 0.02) << sigma_a;
    EXPECT_NEAR(curve.reflectance(curve.sigma_a(law(sigma_a))), law(sigma_a), 1e-9) << sigma_a;
  }
}

TEST(AbsorptionCurve, SlopeIsThatOfItsReflectance) {
  const AbsorptionCurve curve = measured();
  for (const double sigma_a : {0.02, 0.3, 1.1, 4.0})
    EXPECT_NEAR(curve.slope(sigma_a), (curve.reflectance(sigma_a + 1e-5) - curve.reflectance(sigma_a - 1e-5)) / 2e-5,
                1e-3 * std::abs(curve.slope(sigma_a)))
        << sigma_a;
  EXPECT_LT(curve.slope(0), 0);
  EXPECT_LE(curve.slope(12), 0);
  EXPECT_LE(curve.slope(100), 0);
}

TEST(AbsorptionCurve, OutsideOfTheGamutItIsItsNearestEnd) {
  const AbsorptionCurve curve = measured();
  EXPECT_EQ(curve.sigma_a(0.99), 0);
  EXPECT_FALSE(curve.in_gamut(0.99));
  EXPECT_NEAR(curve.sigma_a(0.0), 12, 1e-9);
  EXPECT_FALSE(curve.in_gamut(0.01));
  EXPECT_TRUE(curve.in_gamut(0.4));
}

TEST(AbsorptionCurve, NoiseThatMakesItRiseIsAveragedAway) {
  const AbsorptionCurve curve({0, 1, 2, 3}, {0.8, 0.4, 0.5, 0.1});
  EXPECT_NEAR(curve.reflectance(1), 0.45, 1e-12);
  EXPECT_NEAR(curve.reflectance(2), 0.45, 1e-12);
  EXPECT_THROW(AbsorptionCurve({0, 2, 1}, {3, 2, 1}), std::invalid_argument);
  EXPECT_THROW(AbsorptionCurve({0, 1}, {1}), std::invalid_argument);
}

}  // namespace
}  // namespace inversion
