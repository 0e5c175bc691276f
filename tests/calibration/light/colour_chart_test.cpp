#include "calibration/light/colour_chart.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace calibration {
namespace {

using Eigen::Vector3d;

// Of a camera whose channels overlap; white stays white.
Eigen::Matrix3d true_matrix() {
  Eigen::Matrix3d m;
  m << 1.52, -0.44, -0.08, -0.21, 1.43, -0.22, 0.03, -0.55, 1.52;
  return m;
}

std::vector<Vector3d> measured(double relative_noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> camera;
  for (const ChartSquare& square : colour_chart()) {
    Vector3d value = true_matrix().inverse() * linear_srgb_of_lab(square.lab_d50);
    for (int c = 0; c < 3; ++c) value[c] *= 1 + relative_noise * normal(random);
    camera.push_back(value);
  }
  return camera;
}

std::string refusal(const std::vector<Vector3d>& camera) {
  try {
    fit_colours(camera);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(ColourChart, LabOfWhiteGreyAndThePrimariesIsWhatTheStandardsSay) {
  EXPECT_LT((lab_of_linear_srgb({1, 1, 1}) - Vector3d(100, 0, 0)).norm(), 0.02);  // matrices have 7 digits
  EXPECT_NEAR(lab_of_linear_srgb(Vector3d::Constant(0.184187))[0], 50.0, 0.01);   // Y of L* = 50
  // sRGB red under D50, as ICC profiles have it: X 0.43607, Y 0.22249, Z 0.01392
  const Vector3d red = lab_of_linear_srgb({1, 0, 0});
  EXPECT_NEAR(red[0], 116 * std::cbrt(0.22249) - 16, 0.02);
  EXPECT_NEAR(red[1], 500 * (std::cbrt(0.43607 / 0.96422) - std::cbrt(0.22249)), 0.05);
  for (const ChartSquare& square : colour_chart()) {
    const Vector3d srgb = linear_srgb_of_lab(square.lab_d50);  // cyan's red is below 0
    EXPECT_LT((lab_of_linear_srgb(srgb) - square.lab_d50).norm(), 1e-9) << square.name;
  }
}

TEST(ColourChart, ColourDifferencesAreThoseOfThePublishedPairs) {
  // Sharma, Wu, Dalal 2005, table 1: pairs 1, 7, 10, 17, 25 and 32
  const auto difference = [](std::array<double, 6> p) { return delta_e_2000({p[0], p[1], p[2]}, {p[3], p[4], p[5]}); };
  EXPECT_NEAR(difference({50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485}), 2.0425, 1e-4);
  EXPECT_NEAR(difference({50.0, 0.0, 0.0, 50.0, -1.0, 2.0}), 2.3669, 1e-4);
  EXPECT_NEAR(difference({50.0, 2.49, -0.001, 50.0, -2.49, 0.0010}), 7.1792, 1e-4);
  EXPECT_NEAR(difference({50.0, 2.5, 0.0, 73.0, 25.0, -18.0}), 27.1492, 1e-4);
  EXPECT_NEAR(difference({60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387}), 1.2644, 1e-4);
  EXPECT_NEAR(difference({22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619}), 2.0373, 1e-4);
  EXPECT_EQ(difference({40, 10, 20, 40, 10, 20}), 0);
}

TEST(ColourChart, AKnownCamerasMatrixIsRecoveredAndItsErrorGrowsWithTheNoise) {
  const ColourFit exact = fit_colours(measured(0, 1));
  // white is not quite neutral on the chart, and the fit keeps a perfect diffuser neutral
  EXPECT_LT((exact.linear_srgb_from_camera - true_matrix()).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT(exact.mean_delta_e, 0.05);
  EXPECT_TRUE(all_passed(exact.gates));
  const ColourFit noisy = fit_colours(measured(0.01, 2));
  EXPECT_LT((noisy.linear_srgb_from_camera - true_matrix()).cwiseAbs().maxCoeff(), 0.08);
  EXPECT_GT(noisy.mean_delta_e, exact.mean_delta_e);
  EXPECT_LT(noisy.mean_delta_e, 1.5);  // 1 % per channel is about half a unit
  EXPECT_NEAR((noisy.linear_srgb_from_camera * Vector3d::Ones() - Vector3d::Ones()).norm(), 0, 1e-12);
}

TEST(ColourChart, AChartUpsideDownOrInPartIsRefusedAndAStainedOneFailsItsGate) {
  std::vector<Vector3d> turned = measured(0, 1);
  std::reverse(turned.begin(), turned.end());
  EXPECT_NE(refusal(turned).find("upright"), std::string::npos) << refusal(turned);
  std::vector<Vector3d> part = measured(0, 1);
  part.pop_back();
  EXPECT_NE(refusal(part).find("23 squares"), std::string::npos);
  std::vector<Vector3d> broken = measured(0, 1);
  broken[4].x() = std::nan("");
  EXPECT_NE(refusal(broken).find("blue flower"), std::string::npos);
  std::vector<Vector3d> stained = measured(0, 1);
  stained[2] = stained[14];
  EXPECT_FALSE(all_passed(fit_colours(stained).gates));
}

}  // namespace
}  // namespace calibration
