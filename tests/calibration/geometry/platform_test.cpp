#include "calibration/geometry/platform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibration/sensor/degree.h"
#include "tests/calibration/geometry/synthetic_bench.h"
#include "tests/calibration/geometry/synthetic_views.h"

namespace calibration {
namespace {

using synthetic::axis_error;
using synthetic::Bench;

// Narrow, as on the small simulated bench, but wide enough to see the whole ring.
Lens small_lens() {
  Lens lens = synthetic::narrow_lens();
  lens.fx_px = 1602.0;
  lens.fy_px = 1598.0;
  return lens;
}

const std::vector<double> kReadings = {-60 * kDegree, -36 * kDegree, -12 * kDegree,
                                       12 * kDegree,  36 * kDegree,  60 * kDegree};

std::vector<PlatformPicture> views(const Bench& bench, double sigma_px, unsigned seed) {
  std::mt19937 random(seed);
  return synthetic::turning_views(bench, kReadings, sigma_px, random);
}

PlatformFit fit(const Bench& bench, double sigma_px, unsigned seed) {
  return fit_platform(bench.lens, bench.targets, views(bench, sigma_px, seed));
}

std::string refused(const Bench& bench, const std::vector<PlatformPicture>& seen) {
  try {
    fit_platform(bench.lens, bench.targets, seen);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Platform, ExactCornersGiveTheExactWorldFrame) {
  const Bench b = synthetic::bench(small_lens());
  const PlatformFit found = fit(b, 0.0, 1);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(found.rms_px, 1e-6);
  EXPECT_TRUE(found.world_from_camera.isApprox(b.world_from_camera, 1e-6));
  EXPECT_TRUE(found.world_from_ring.isApprox(b.world_from_ring, 1e-6));
  EXPECT_TRUE(found.world_from_table.isApprox(b.world_from_table, 1e-6));
  EXPECT_NEAR(found.scale, 1.004, 1e-7);
  EXPECT_NEAR(found.axis_to_table_normal_rad, 0.4 * kDegree, 1e-6);
  ASSERT_EQ(found.angles_rad.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found.angles_rad[i], 1.004 * kReadings[i], 1e-7);
}

TEST(Platform, TheFittedFrameIsTheWorldFrameOfItsDefinition) {
  const PlatformFit found = fit(synthetic::bench(small_lens()), 0.1, 3);
  const Eigen::Vector3d eye = found.world_from_camera.translation();
  EXPECT_NEAR(eye.y(), 0.0, 1e-6);  // +x is the horizontal direction to the camera
  EXPECT_GT(eye.x(), 0.0);
  EXPECT_GT(eye.z(), 0.0);
}

TEST(Platform, ThePredictedUncertaintyIsTheObservedSpread) {
  constexpr int kDraws = 40;
  const Bench b = synthetic::bench(small_lens());
  Eigen::Vector4d observed = Eigen::Vector4d::Zero(), predicted = observed;
  double mahalanobis = 0.0;
  for (unsigned draw = 0; draw < kDraws; ++draw) {
    const PlatformFit found = fit(b, 0.1, 100 + draw);
    const Eigen::Vector4d error = axis_error(found, b);
    observed += error.cwiseAbs2() / kDraws;
    predicted += found.axis_covariance.diagonal() / kDraws;
    mahalanobis += error.dot(found.axis_covariance.ldlt().solve(error)) / kDraws;
  }
  for (int i = 0; i < 4; ++i) {
    RecordProperty("sigma_" + std::to_string(i), std::to_string(std::sqrt(predicted[i])));
    // a standard deviation from 40 draws is known to 11 %; 35 % is three times that
    EXPECT_NEAR(std::sqrt(observed[i] / predicted[i]), 1.0, 0.35) << "component " << i;
  }
  EXPECT_NEAR(mahalanobis, 4.0, 1.5);  // chi-square of 4 over 40 draws: 4 +- 0.45
}

TEST(Platform, ATurntableThatCountsClockwiseHasANegativeScale) {
  Bench b = synthetic::bench(small_lens());
  b.scale = -0.998;
  const PlatformFit found = fit(b, 0.1, 7);
  EXPECT_NEAR(found.scale, -0.998, 0.0005);
  EXPECT_LT(axis_error(found, b).tail<2>().norm(), 0.1);
  EXPECT_GT(found.world_from_camera.translation().z(), 0.0);
}

TEST(Platform, AngleZeroIsWhereTheReadingIsZeroNotWhereTheFirstViewWas) {
  const Bench b = synthetic::bench(small_lens());
  std::vector<double> readings = kReadings;
  for (double& reading : readings) reading += 8.0 * kDegree;
  std::mt19937 random(7);
  const PlatformFit found = fit_platform(b.lens, b.targets, synthetic::turning_views(b, readings, 0.0, random));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found.angles_rad[i], b.scale * readings[i], 1e-7);
  EXPECT_TRUE(found.world_from_ring.isApprox(b.world_from_ring, 1e-6));
}

TEST(Platform, AnAngleIsMeasuredFromTheRingBehindAStandingHolder) {
  const Bench b = synthetic::bench(small_lens());
  const PlatformFit platform = fit(b, 0.05, 11);
  std::mt19937 random(12);
  for (const double degrees : {-170.0, -45.0, 0.0, 27.0, 120.0}) {
    const auto found =
        measure_angle(b.lens, platform, b.targets.ring, synthetic::holder_view(b, degrees * kDegree, 0.05, random));
    ASSERT_TRUE(found.has_value()) << degrees;
    // 0.05 px of 1600 px per radian at 600 mm is 0.02 mm on a 56 mm lever: 0.02 degrees a corner, 0.004 for twenty
    EXPECT_NEAR(found->angle_rad, degrees * kDegree, 0.02 * kDegree);
    EXPECT_LT(found->sigma_rad, 0.02 * kDegree);
  }
  EXPECT_FALSE(measure_angle(b.lens, platform, b.targets.ring, {}).has_value());
}

TEST(Platform, ViewsThatCannotDetermineAnAxisAreRefused) {
  const Bench b = synthetic::bench(small_lens());
  const auto turning = views(b, 0.1, 1);
  EXPECT_NE(refused(b, {turning[0], turning[1]}).find("at least 3"), std::string::npos);
  auto no_table = turning;
  for (PlatformPicture& view : no_table)
    std::erase_if(view.seen, [](const TagDetection& tag) { return tag.id >= 400; });
  EXPECT_NE(refused(b, no_table).find("table"), std::string::npos);
  Bench thick = b;
  thick.targets.table_height_mm = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refused(thick, turning).find("thickness"), std::string::npos);
  auto missing = turning;
  missing[2].seen.clear();
  EXPECT_NE(refused(b, missing).find("picture 3"), std::string::npos);
  auto broken = turning;
  broken[1].seen[0].corners_px[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refused(b, broken).find("finite"), std::string::npos);
  Bench stuck = b;  // the platform did not move although the readings did
  stuck.scale = 0.0;
  EXPECT_NE(refused(b, views(stuck, 0.1, 1)).find("turns by"), std::string::npos);
}

TEST(Platform, ACameraThatWasBumpedBetweenViewsIsNamedWithTheView) {
  const Bench b = synthetic::bench(small_lens());
  auto turning = views(b, 0.1, 1);
  Bench bumped = b;
  bumped.world_from_camera.rotate(Eigen::AngleAxisd(0.1 * kDegree, Eigen::Vector3d::UnitY()));  // 2.8 px
  const auto after = views(bumped, 0.1, 2);
  turning[4] = after[4];
  turning[5] = after[5];
  const std::string message = refused(b, turning);
  EXPECT_NE(message.find("picture 5"), std::string::npos) << message;
  EXPECT_NE(message.find("bumped"), std::string::npos) << message;
}

TEST(Platform, ATagThatWasMovedOrSwappedIsNamed) {
  const Bench b = synthetic::bench(small_lens());
  auto swapped = views(b, 0.1, 1);
  for (PlatformPicture& view : swapped)
    for (TagDetection& tag : view.seen)
      if (tag.id == 301 || tag.id == 304) tag.id = 605 - tag.id;
  EXPECT_NE(refused(b, swapped).find("301, 304"), std::string::npos) << refused(b, swapped);
  Bench shifted = b;  // the print is not what the layout says
  shifted.targets.ring.tags[3].object_from_tag.pretranslate(Eigen::Vector3d(0.8, 0, 0));
  EXPECT_NE(refused(b, views(shifted, 0.1, 1)).find("tag 303"), std::string::npos)
      << refused(b, views(shifted, 0.1, 1));
  Bench moved = b;  // one of the table's tags, half-way through
  moved.targets.table.tags[1].object_from_tag.pretranslate(Eigen::Vector3d(0, 1.5, 0));
  auto half = views(b, 0.1, 1);
  half[5] = views(moved, 0.1, 2)[5];
  EXPECT_NE(refused(b, half).find("tag 401 on the table moved"), std::string::npos) << refused(b, half);
}

}  // namespace
}  // namespace calibration
