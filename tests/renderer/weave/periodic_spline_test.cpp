#include "renderer/weave/periodic_spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace renderer {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> rough_points(int count, const Vector3d& period, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-0.3, 0.3);
  std::vector<Vector3d> points;
  for (int k = 0; k < count; ++k)
    points.push_back(k * period / count + Vector3d(noise(random), noise(random), noise(random)));
  return points;
}

TEST(PeriodicSplineTest, PassesThroughItsPoints) {
  const Vector3d period(0.4, 5, 0);
  for (int count : {3, 4, 7, 64}) {
    const auto points = rough_points(count, period, 7);
    const PeriodicSpline spline = spline_through(points, period);
    for (int k = 0; k < count; ++k) {
      const double miss = (spline_value(spline, k) - points[static_cast<std::size_t>(k)]).norm();
      EXPECT_LT(miss, 1e-13) << count << " points";  // a well-conditioned solve: rounding only
    }
  }
}

TEST(PeriodicSplineTest, ValueAndTwoDerivativesContinueAcrossThePeriod) {
  const Vector3d period(3, 0, 0);
  const PeriodicSpline spline = spline_through(rough_points(9, period, 3), period);
  for (double t : {0.0, 0.3, 4.0, 8.999}) {
    EXPECT_LT((spline_value(spline, t + 9) - spline_value(spline, t) - period).norm(), 1e-12);
    EXPECT_LT((spline_value(spline, t - 18) - spline_value(spline, t) + 2 * period).norm(), 1e-12);
  }
  for (double knot : {0.0, 5.0, 9.0}) {
    for (int derivative : {0, 1, 2}) {
      const Vector3d left = spline_value(spline, knot - 1e-9, derivative),
                     right = spline_value(spline, knot, derivative);
      EXPECT_LT((left - right).norm(), 1e-7) << derivative;  // 1e-9 times a slope below 100
    }
  }
}

TEST(PeriodicSplineTest, DerivativesAreFiniteDifferences) {
  const Vector3d period(3, 0, 0);
  const PeriodicSpline spline = spline_through(rough_points(6, period, 5), period);
  const double step = 1e-5;
  for (double t : {0.2, 2.7, 5.5}) {
    for (int derivative : {0, 1}) {
      const Vector3d difference =
          (spline_value(spline, t + step, derivative) - spline_value(spline, t - step, derivative)) / (2 * step);
      EXPECT_LT((difference - spline_value(spline, t, derivative + 1)).norm(), 1e-8);  // central differences: step^2
    }
  }
}

TEST(PeriodicSplineTest, LengthOfAStraightLineAndOfASineWaveAreRight) {
  const Vector3d period(2, 0, 0);
  std::vector<Vector3d> line, wave;
  for (int k = 0; k < 64; ++k) {
    line.push_back({k / 32.0, 0.1, 0.2});
    wave.push_back({k / 32.0, 0, 0.2 * std::sin(std::numbers::pi * k / 32.0)});
  }
  EXPECT_NEAR(spline_length(spline_through(line, period)), 2, 1e-12);
  double length = 0;  // of the sine itself, by the trapezoidal rule, which is spectrally exact for periodic integrands
  for (int k = 0; k < 1000; ++k)
    length += std::hypot(1, 0.2 * std::numbers::pi * std::cos(std::numbers::pi * k / 500.0)) / 500;
  EXPECT_NEAR(spline_length(spline_through(wave, period)), length, 2e-6);  // cubic interpolation: (pi / 32)^4 / 384
}

}  // namespace
}  // namespace renderer
