#include "calibration/geometry/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibration/sensor/degree.h"
#include "tests/calibration/geometry/synthetic_bench.h"
#include "tests/calibration/geometry/synthetic_views.h"

namespace calibration {
namespace {

using synthetic::facing;

// Error of a pose in the terms of PoseFit::covariance.
Eigen::Matrix<double, 6, 1> error_of(const Eigen::Isometry3d& found, const Eigen::Isometry3d& truth) {
  const Eigen::AngleAxisd turn(found.linear() * truth.linear().transpose());
  Eigen::Matrix<double, 6, 1> error;
  error << turn.angle() * turn.axis(), found.translation() - truth.translation();
  return error;
}

std::vector<Eigen::Isometry3d> poses() {
  return {facing(600, 0, 0, 0), facing(500, 35 * kDegree, -20 * kDegree, 100 * kDegree),
          facing(700, 0, -65 * kDegree, 0, {10, 5}), facing(600, -55 * kDegree, 10 * kDegree, 0)};
}

TEST(Pose, ExactCornersGiveTheExactPose) {
  std::mt19937 random(1);
  for (const Eigen::Isometry3d& truth : poses()) {
    const auto fit = fit_pose(synthetic::narrow_lens(), synthetic::board(),
                              synthetic::observe(synthetic::narrow_lens(), synthetic::board(), truth, 0.0, random));
    ASSERT_TRUE(fit.has_value());
    EXPECT_TRUE(fit->converged);
    EXPECT_LT(error_of(fit->camera_from_object, truth).head<3>().norm(), 1e-6);
    EXPECT_LT(error_of(fit->camera_from_object, truth).tail<3>().norm(), 1e-3);  // mm; the depth's scale is 600 mm
    EXPECT_LT(fit->rms_px, 1e-6);
  }
}

TEST(Pose, AnObjectThatIsNotFlatIsFoundToo) {
  TagLayout cube = make_tag_board("cube", 1, 2, 12.0, 20.0, 0);
  cube.tags[1].object_from_tag =
      Eigen::Translation3d(10, 0, -8) * Eigen::AngleAxisd(50 * kDegree, Eigen::Vector3d::UnitY());
  std::mt19937 random(1);
  const Eigen::Isometry3d truth = facing(600, -20 * kDegree, 15 * kDegree, 0);
  const auto fit =
      fit_pose(synthetic::narrow_lens(), cube, synthetic::observe(synthetic::narrow_lens(), cube, truth, 0.0, random));
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(fit->tags_used, 2);
  EXPECT_LT(error_of(fit->camera_from_object, truth).tail<3>().norm(), 1e-3);
}

TEST(Pose, ThePredictedUncertaintyIsTheObservedSpread) {
  std::mt19937 random(5);
  constexpr int kDraws = 200;
  for (const Eigen::Isometry3d& truth : poses()) {
    Eigen::Matrix<double, 6, 1> observed = Eigen::Matrix<double, 6, 1>::Zero(), predicted = observed;
    for (int draw = 0; draw < kDraws; ++draw) {
      const auto fit = fit_pose(synthetic::narrow_lens(), synthetic::board(),
                                synthetic::observe(synthetic::narrow_lens(), synthetic::board(), truth, 0.1, random));
      ASSERT_TRUE(fit.has_value());
      const auto error = error_of(fit->camera_from_object, truth);
      observed += error.cwiseAbs2() / kDraws;
      predicted += fit->covariance.diagonal() / kDraws;
      EXPECT_NEAR(fit->rms_px, 0.1, 0.05);  // 5 sigma of a standard deviation from 50 and more numbers
    }
    for (int i = 0; i < 6; ++i) {
      // a standard deviation from 200 draws is known to 5 %; 20 % is four times that
      EXPECT_NEAR(std::sqrt(observed[i] / predicted[i]), 1.0, 0.2) << "component " << i;
    }
  }
}

TEST(Pose, ABoardAtWorkingDistanceIsFoundToATenthOfADegree) {
  // 0.1 px of 2400 px per radian over a 110 mm board at 600 mm: 0.02 mm across, 0.3 mm in depth, 0.1 degree in tilt
  std::mt19937 random(3);
  const Eigen::Isometry3d truth = facing(600, 30 * kDegree, 20 * kDegree, 0);
  const auto fit = fit_pose(synthetic::narrow_lens(), synthetic::board(),
                            synthetic::observe(synthetic::narrow_lens(), synthetic::board(), truth, 0.1, random));
  ASSERT_TRUE(fit.has_value());
  const auto error = error_of(fit->camera_from_object, truth);
  EXPECT_LT(error.head<3>().norm(), 0.1 * kDegree);
  EXPECT_LT(error.segment<2>(3).norm(), 0.03);
  EXPECT_LT(std::abs(error[5]), 0.3);
}

TEST(Pose, WithoutATagOfTheLayoutThereIsNoPose) {
  EXPECT_FALSE(fit_pose(synthetic::narrow_lens(), synthetic::board(), {}).has_value());
  std::mt19937 random(3);
  const TagLayout other = make_tag_board("other", 1, 1, 20.0, 30.0, 99);
  const TagObservation seen = synthetic::observe(synthetic::narrow_lens(), other, facing(600, 0, 0, 0), 0.05, random);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_FALSE(fit_pose(synthetic::narrow_lens(), synthetic::board(), seen).has_value());
}

TEST(Pose, ACornerThatIsNotANumberIsRefused) {
  std::mt19937 random(3);
  TagObservation seen =
      synthetic::observe(synthetic::narrow_lens(), synthetic::board(), facing(600, 0, 0, 0), 0.05, random);
  seen[2].corners_px[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(fit_pose(synthetic::narrow_lens(), synthetic::board(), seen), std::runtime_error);
}

TEST(Pose, ATagOutOfPlaceIsLeftOutAndNamed) {
  std::mt19937 random(21);
  const Eigen::Isometry3d truth = facing(600, 30 * kDegree, 20 * kDegree, 0);
  const Lens lens = synthetic::narrow_lens();
  for (const double sigma_px : {0.0, 0.2}) {
    TagObservation seen = synthetic::observe(lens, synthetic::board(), truth, sigma_px, random);
    ASSERT_GE(seen.size(), 8U);
    std::swap(seen[1].corners_px, seen[6].corners_px);
    const auto fit = fit_pose(lens, synthetic::board(), seen);
    ASSERT_TRUE(fit.has_value());
    EXPECT_EQ(fit->odd_tags, (std::vector<int>{seen[1].id, seen[6].id}));
    // as ABoardAtWorkingDistance..., for twice its noise
    EXPECT_LT(error_of(fit->camera_from_object, truth).tail<3>().norm(), sigma_px > 0 ? 1.0 : 1e-3);
  }
}

TEST(Pose, SightingsFromObliqueAnglesFindTheDistanceThatFrontalOnesHide) {
  const synthetic::Bench b = synthetic::bench(synthetic::full_size_lens());
  const auto sighting = [&](double degrees, std::mt19937& random) {
    const double angle_rad = degrees * kDegree;
    const Eigen::Isometry3d world_from_platform(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
    return Sighting{b.world_from_camera.inverse() * world_from_platform,
                    synthetic::holder_view(b, angle_rad, 0.2, random)};
  };
  constexpr int kDraws = 60;
  std::mt19937 random(31);
  const auto spread = [&](const std::vector<double>& angles_deg) {
    Eigen::Matrix<double, 6, 1> observed = Eigen::Matrix<double, 6, 1>::Zero(), predicted = observed;
    for (int draw = 0; draw < kDraws; ++draw) {
      std::vector<Sighting> sightings;
      for (const double degrees : angles_deg) sightings.push_back(sighting(degrees, random));
      const auto fit = fit_mounted_pose(b.lens, b.holder, sightings);
      observed += error_of(fit->platform_from_object, b.platform_from_holder).cwiseAbs2() / kDraws;
      predicted += fit->covariance.diagonal() / kDraws;
    }
    for (int i = 0; i < 6; ++i)  // known to 9 % from 60 draws
      EXPECT_NEAR(std::sqrt(observed[i] / predicted[i]), 1.0, 0.3) << "component " << i;
    return Eigen::Matrix<double, 6, 1>(observed.cwiseSqrt());
  };
  const auto frontal = spread({0.0, 0.0}), oblique = spread({-35.0, 35.0});
  RecordProperty("distance_frontal_mm", std::to_string(frontal[3]));
  RecordProperty("distance_oblique_mm", std::to_string(oblique[3]));
  EXPECT_GT(frontal[3], 5.0 * oblique[3]);
  EXPECT_LT(oblique.head<3>().maxCoeff(), 0.02 * kDegree);
}

}  // namespace
}  // namespace calibration
