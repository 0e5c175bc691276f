#include "inversion/solve/adam.h"

#include <gtest/gtest.h>

namespace inversion {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

double bowl(const VectorXd& at, VectorXd& gradient) {
  const Vector2d centre(0.3, -0.2), steepness(1, 100);
  gradient = steepness.cwiseProduct(at - centre);
  return 0.5 * (at - centre).cwiseProduct(steepness).dot(at - centre);
}

TEST(AdamTest, FirstStepsAreOfTheRateWhateverTheGradientsSize) {
  VectorXd at = Vector2d(1, 1);
  minimise_by_adam([](int, const VectorXd& x, VectorXd& g) { return bowl(x, g); }, {.steps = 1}, Vector2d(-9, -9),
                   Vector2d(9, 9), at);
  EXPECT_NEAR(at[0], 0.99, 1e-9);
  EXPECT_NEAR(at[1], 0.99, 1e-9);
}

TEST(AdamTest, FindsTheLowestPointAndReportsTheLossesOnTheWay) {
  VectorXd at = Vector2d(1, 1);
  const auto losses = minimise_by_adam([](int, const VectorXd& x, VectorXd& g) { return bowl(x, g); }, {.steps = 2000},
                                       Vector2d(-9, -9), Vector2d(9, 9), at);
  ASSERT_EQ(losses.size(), 2000U);
  EXPECT_LT(losses.back(), 1e-6 * losses.front());
  EXPECT_NEAR(at[0], 0.3, 1e-3);
}

TEST(AdamTest, StaysWithinTheBounds) {
  VectorXd at = Vector2d(1, 1);
  minimise_by_adam([](int, const VectorXd& x, VectorXd& g) { return bowl(x, g); }, {.steps = 500}, Vector2d(0.5, 0),
                   Vector2d(9, 9), at);
  EXPECT_EQ(at, Vector2d(0.5, 0));
}

}  // namespace
}  // namespace inversion
