#include "calibration/light/light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "calibration/sensor/degree.h"
#include "tests/calibration/light/synthetic_panel.h"

namespace calibration {
namespace {

using Eigen::Vector3d;
using synthetic::Imperfections, synthetic::LampTruth, synthetic::PanelPictures;

const Imperfections kNone{.noise = 0, .drift = 0, .turn_rad = 0, .shift_mm = 0};
const Imperfections kNoiseOnly{.noise = 0.003, .drift = 0, .turn_rad = 0, .shift_mm = 0};
const Imperfections kMonitored{.monitored = 0.001};

// Planned poses under each light, on two stands, seen with the given errors; tape measures that are some 25 mm wrong.
struct LitBench {
  explicit LitBench(const Imperfections& by, const LampTruth& lamp = {}, double tape_error_mm = 15, unsigned seed = 5,
                    int pictures = 4)
      : truth(lamp), random(seed), guesses(synthetic::taped(truth, random, tape_error_mm)) {
    poses = synthetic::planned_poses(synthetic::taped(truth, random, 0), {{2, pictures}, {2, pictures}}).poses;
    seen = synthetic::panel_pictures(truth, poses, by, random);
  }
  LightFit fit() const { return fit_light(seen.spots, guesses, synthetic::panel_options(), seen.pictures); }
  std::string refusal() const {
    try {
      fit();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  }
  void keep(const std::function<bool(const PanelSpot&)>& wanted) {
    std::erase_if(seen.spots, [&](const PanelSpot& spot) { return !wanted(spot); });
  }

  LampTruth truth;
  std::mt19937 random;
  std::vector<LightGuess> guesses;
  std::vector<PanelPose> poses;
  PanelPictures seen;
};

// The first gate that failed; empty when all passed.
std::string failure(const LightFit& fit) {
  for (const Gate& gate : fit.gates)
    if (!gate.passed) return gate.reason;
  return {};
}

TEST(Light, ExactRadiancesGiveTheExactLampPanelAndVignetting) {
  LitBench bench(kNone, {.mu = 0.6, .droop = 0.11, .table_albedo = 0});
  const LightFit fit = bench.fit();
  EXPECT_TRUE(fit.converged);
  EXPECT_EQ(failure(fit), "");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT((fit.positions[i] - bench.truth.positions[i]).norm(), 0.05);
    for (const Vector3d& point : {Vector3d(0, 0, 64), Vector3d(40, -40, 24)}) {
      const Vector3d exact = synthetic::true_irradiance(bench.truth, i, point);
      EXPECT_LT((facing_irradiance(fit, i, point) - exact).norm() / exact.norm(), 1e-4);
    }
  }
  EXPECT_NEAR(fit.beam_exponent, 0.6, 1e-2);
  EXPECT_NEAR(fit.droop[0], 0.11, 1e-3);
  EXPECT_NEAR(fit.droop[1], 0, 1e-3);
  EXPECT_NEAR(fit.vignetting.v0, -0.18, 1e-3);
  EXPECT_NEAR(fit.vignetting.v1, -0.03, 1e-3);
  EXPECT_LT(fit.relative_rms, 1e-5);
}

TEST(Light, ALampThatDriftsIsFoundToMillimetresWithAReferenceChip) {
  LitBench bench(kMonitored);
  const LightFit fit = bench.fit();
  EXPECT_TRUE(fit.converged);
  EXPECT_EQ(failure(fit), "");
  for (std::size_t i = 0; i < 2; ++i)  // simulated: 1.4 mm rms; three times that
    EXPECT_LT((fit.positions[i] - bench.truth.positions[i]).norm(), 4.5);
  for (std::size_t i = 0; i < fit.held_out.size(); ++i)  // the outputs that were read, to twice what poses add
    EXPECT_NEAR(fit.held_out[i].output / bench.seen.pictures[i].output.value(), 1, 0.012);
}

TEST(Light, WithoutAReferenceChipADriftingLampIsFoundButNotAccepted) {
  LitBench bench({.drift = 0.01});
  const LightFit fit = bench.fit();
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LT((fit.positions[i] - bench.truth.positions[i]).norm(), 15);  // 2.6 mm rms for half the drift
  EXPECT_NE(failure(fit).find("warm up"), std::string::npos) << failure(fit);
}

TEST(Light, TheCovarianceDoesNotDependOnTheUnitOfRadiance) {
  LitBench dim(kNoiseOnly), bright(kNoiseOnly);
  for (PanelSpot& spot : bright.seen.spots) spot.radiance *= 1e6, spot.sigma *= 1e6;
  const LightFit a = dim.fit(), b = bright.fit();
  EXPECT_TRUE(b.converged);
  // the same noise; 1 % for where the two iterations end
  for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE(b.position_covariances[i].isApprox(a.position_covariances[i], 0.01));
  EXPECT_TRUE((b.intensity_covariance * 1e-12).isApprox(a.intensity_covariance, 0.01));
}

TEST(Light, AStainOnThePanelDoesNotPullTheLight) {
  LitBench bench(kNoiseOnly);
  const LightFit clean = bench.fit();
  for (std::size_t i = 7; i < bench.seen.spots.size(); i += 25) bench.seen.spots[i].radiance *= 0.7;
  const LightFit stained = bench.fit();
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((stained.positions[i] - clean.positions[i]).norm(), 5.0);
}

TEST(Light, SpotsThatDoNotFaceTheirLightAreLeftOut) {
  LitBench bench(kNoiseOnly);
  const LightFit without = bench.fit();
  PanelSpot away = bench.seen.spots.front();
  away.normal = -away.normal;
  bench.seen.spots.push_back(away);
  const LightFit with = bench.fit();
  EXPECT_EQ(with.spots_used, without.spots_used);
  EXPECT_TRUE(with.positions[0].isApprox(without.positions[0]));
}

TEST(Light, ATapeThatIsWrongByTenCentimetresIsCorrected) {
  LitBench bench(kNoiseOnly, {}, 15, 5, 10);  // as many pictures as the guided calibration takes
  bench.guesses[0].position += Vector3d(60, -60, 50);
  const LightFit fit = bench.fit();
  EXPECT_LT((fit.positions[0] - bench.truth.positions[0]).norm(), 5);
  EXPECT_EQ(failure(fit), "");
}

TEST(Light, AMovedLampAndARoomLightAreNoticedAndThePictureIsNamed) {
  LitBench moved(kMonitored);
  LampTruth elsewhere = moved.truth;
  elsewhere.positions[0] += Vector3d(0, 60, 0);
  const PanelPictures after = synthetic::panel_pictures(elsewhere, moved.poses, kMonitored, moved.random);
  for (std::size_t i = 0; i < moved.seen.spots.size(); ++i)
    if (moved.seen.spots[i].picture >= 4) moved.seen.spots[i] = after.spots[i];
  EXPECT_NE(failure(moved.fit()), "");

  LitBench lit(kMonitored);
  for (PanelSpot& spot : lit.seen.spots)
    if (spot.picture == 2) spot.radiance *= 1.08;  // as much as a room light adds
  const LightFit fit = lit.fit();
  EXPECT_TRUE(std::any_of(fit.gates.begin(), fit.gates.end(), [](const Gate& gate) {
    return !gate.passed && gate.reason.find("pose 3") != std::string::npos;
  })) << failure(fit);
}

TEST(Light, ADarkPictureIsNamed) {
  LitBench bench(kNoiseOnly);
  for (PanelSpot& spot : bench.seen.spots)
    if (spot.picture == 9) spot.radiance *= 0.05, spot.sigma *= 0.05;
  EXPECT_NE(bench.refusal().find("pose 10 is dark"), std::string::npos) << bench.refusal();
}

TEST(Light, PosesThatLeaveALightUndeterminedAreRefusedWithThePoseThatIsMissing) {
  LitBench one_pose(kNoiseOnly);
  one_pose.keep([](const PanelSpot& spot) { return spot.light == 1 || spot.picture == 0; });
  EXPECT_NE(one_pose.refusal().find("front lamp the panel was seen in one direction"), std::string::npos)
      << one_pose.refusal();

  LitBench few(kNoiseOnly);
  few.keep([](const PanelSpot& spot) { return spot.light == 1 || spot.picture < 4; });
  EXPECT_NE(few.refusal().find("in 4 poses, at least 6"), std::string::npos) << few.refusal();

  // Turned by 6 degrees only, under either lamp: nearer looks like brighter.
  LitBench flat(kNoiseOnly);
  for (std::size_t i = 0; i < flat.poses.size(); ++i) {
    const std::size_t light = i < 8 ? 0 : 1;
    Eigen::Isometry3d& pose = flat.poses[i].world_from_panel;
    pose.translation() = Vector3d(0, 0, 76);
    const Vector3d to_light = (flat.truth.positions[light] - pose.translation()).normalized();
    const Vector3d to_camera = (synthetic::panel_bench().camera.world_from_camera.translation() - pose.translation());
    const Vector3d half = (to_light + to_camera.normalized()).normalized();
    const Vector3d normal = (half + 0.055 * (i % 2 ? 1 : -1) * half.unitOrthogonal()).normalized();
    pose.linear().col(0) = Vector3d::UnitZ().cross(normal).normalized();
    pose.linear().col(1) = normal.cross(pose.linear().col(0));
    pose.linear().col(2) = normal;
  }
  flat.seen = synthetic::panel_pictures(flat.truth, flat.poses, kNoiseOnly, flat.random);
  EXPECT_NE(flat.refusal().find("front lamp uncertain by"), std::string::npos) << flat.refusal();
  EXPECT_NE(flat.refusal().find("add poses"), std::string::npos) << flat.refusal();
}

TEST(Light, MeasurementsThatMakeNoSenseAreRefused) {
  const LitBench good(kNoiseOnly);
  const auto refused = [&](const auto& change, double albedo = 0.99) {
    LitBench bench = good;
    change(bench);
    LightOptions options = synthetic::panel_options();
    options.albedo = albedo;
    try {
      fit_light(bench.seen.spots, bench.guesses, options, bench.seen.pictures);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused([](LitBench& b) { b.seen.spots.clear(); }).find("front lamp lights 0"), std::string::npos);
  EXPECT_NE(refused([](LitBench& b) {
              b.keep([](const PanelSpot& spot) { return spot.light == 0; });
            }).find("back lamp lights 0 spots"),
            std::string::npos);
  EXPECT_NE(refused([](LitBench&) {}, 0.0).find("albedo"), std::string::npos);
  EXPECT_NE(refused([](LitBench& b) {
              b.seen.spots[5].radiance.y() = std::numeric_limits<double>::quiet_NaN();
            }).find("finite"),
            std::string::npos);
  EXPECT_NE(refused([](LitBench& b) { b.seen.spots[5].light = 2; }).find("light 2"), std::string::npos);
  EXPECT_NE(refused([](LitBench& b) { b.seen.spots[5].picture = 99; }).find("picture 99"), std::string::npos);
  EXPECT_NE(refused([](LitBench& b) { b.seen.pictures[3].output = -1; }).find("pose 4"), std::string::npos);
}

TEST(Light, VignettingIsOneInTheMiddleAndItsFormulaInTheCorner) {
  const cv::Size size(600, 400);
  const Vignetting v{.v0 = -0.2, .v1 = 0.05};
  EXPECT_DOUBLE_EQ(v.gain(299.5, 199.5, size), 1.0);
  EXPECT_NEAR(v.gain(-0.5, -0.5, size), 0.85, 1e-12);  // the outer corner of the first pixel: r = 1
}

TEST(LightPlan, PosesKeepOffGrazingAndMirrorDirectionsAndShowTags) {
  const PanelBench bench = synthetic::panel_bench();
  std::mt19937 random(3);
  const auto lights = synthetic::taped({}, random);
  const auto poses = synthetic::planned_poses(lights, {{2, 6}, {2, 6}}).poses;
  ASSERT_EQ(poses.size(), 24U);
  for (const PanelPose& pose : poses) {
    const Vector3d centre = pose.world_from_panel.translation(), normal = pose.world_from_panel.linear().col(2);
    const Vector3d to_light = (lights[static_cast<std::size_t>(pose.light)].position - centre).normalized(),
                   to_camera = (bench.camera.world_from_camera.translation() - centre).normalized();
    const double steepest = pose.light == 0 ? 45 : 70;  // behind, lamp and camera are 110 degrees apart
    EXPECT_GT(normal.dot(to_light), std::cos(steepest * kDegree) - 1e-9);
    EXPECT_GT(normal.dot(to_camera), std::cos(steepest * kDegree) - 1e-9);
    EXPECT_LT((2 * normal.dot(to_light) * normal - to_light).dot(to_camera), std::cos(20 * kDegree));
    EXPECT_GE(tags_in_picture(bench.camera, bench.tags, pose.world_from_panel), 2);
  }
}

TEST(LightPlan, EachLightHasItsMountingsOnDifferentStandsWithinThePlatformsReach) {
  std::mt19937 random(3);
  const auto lights = synthetic::taped({}, random);
  const auto plan = plan_panel_mountings(synthetic::panel_bench(), lights, synthetic::panel_stands(), {{2, 6}, {2, 6}},
                                         90 * kDegree, synthetic::panel_options());
  ASSERT_EQ(plan.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(plan[i].light, i / 2);
    EXPECT_EQ(plan[i].angles_rad.size(), 6U);
    EXPECT_TRUE(std::is_sorted(plan[i].angles_rad.begin(), plan[i].angles_rad.end()));
    EXPECT_LE(std::max(-plan[i].angles_rad.front(), plan[i].angles_rad.back()), 90 * kDegree + 1e-9);
  }
  EXPECT_NE(plan[0].stand, plan[1].stand);
  EXPECT_NE(plan[2].stand, plan[3].stand);
}

TEST(LightPlan, AStandThatIsTurnedByTheHandIsTurnedBackByThePlatform) {
  std::mt19937 random(3);
  const auto lights = synthetic::taped({}, random, 0);
  const auto angles = [&](const Eigen::Isometry3d& standing) {
    return plan_panel_angles(synthetic::panel_bench(), lights, {}, 0, standing, 5, 180 * kDegree,
                             synthetic::panel_options());
  };
  const Eigen::Isometry3d straight = synthetic::panel_stands()[1],
                          turned = Eigen::AngleAxisd(10 * kDegree, Vector3d::UnitZ()) * straight;
  const auto as_wanted = angles(straight), after_the_hand = angles(turned);
  ASSERT_EQ(as_wanted.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(after_the_hand[i], as_wanted[i] - 10 * kDegree, 1e-9);
}

TEST(LightPlan, ALightThatNoPoseShowsIsNamed) {
  std::mt19937 random(3);
  auto lights = synthetic::taped({}, random);
  lights[1].position = {-400, 0, -300};  // below the table
  try {
    synthetic::planned_poses(lights, {{2, 6}, {2, 6}});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("back lamp"), std::string::npos);
  }
}

}  // namespace
}  // namespace calibration
