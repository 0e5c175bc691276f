// The evidence for the thread model: it fits what many fibers do, and models with uniform back lobes do not.
#include <gtest/gtest.h>

#include <cmath>

#include "renderer/scattering/azimuthal_fit.h"
#include "renderer/scattering/degree.h"
#include "renderer/scattering/multi_fiber.h"

namespace renderer {
namespace {

// A white thread under eight inclinations, and its joint fit; made once for all tests.
const std::vector<AzimuthalData>& simulated() {
  static const std::vector<AzimuthalData> distributions = [] {
    std::vector<AzimuthalData> data;
    for (double theta_deg : {0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 75.0, 80.0}) {
      const std::vector<double> density = simulate_multi_fiber({.theta_rad = theta_deg * kDegree}).density;
      data.push_back({.theta_rad = theta_deg * kDegree,
                      .density = Eigen::Map<const Eigen::ArrayXd>(density.data(), std::ssize(density))});
    }
    return data;
  }();
  return distributions;
}

const JointThreadFit& joint_fit() {
  static const JointThreadFit fit = fit_thread_jointly(simulated());
  return fit;
}

TEST(ScatteringEvidence, TheThreadModelFitsManyFibersAtEachAngleAndJointly) {
  const std::vector<AzimuthalData>& data = simulated();
  const JointThreadFit& joint = joint_fit();
  EXPECT_LE(joint.error, 0.07);
  EXPECT_TRUE(joint.converged);
  for (const AzimuthalData& d : data) {
    const double theta_deg = d.theta_rad / kDegree;
    const SeparateThreadFit fit = fit_thread_separately(d);
    EXPECT_LE(fit.error, theta_deg < 61 ? 0.05 : 0.06) << theta_deg;
    EXPECT_LT(2 * fit.error, fit_yarn({d}, 0.1).error) << theta_deg;
    EXPECT_LT(2 * fit.error, fit_forward_and_uniform(d).error) << "no model with a uniform back lobe comes near";
  }
  EXPECT_LT(3 * joint.error, fit_yarn(data, 0.1).error);
}

TEST(ScatteringEvidence, EnergiesFollowTheTrendsOfEquationFive) {
  const ThreadParameters& p = joint_fit().parameters;
  EXPECT_LT(p.r0a, -0.2) << "lambda_0 is concave";
  EXPECT_GT(p.r1a, 0.5) << "lambda_1 rises with cos theta";
  EXPECT_GT(p.r2a, 5) << "lambda_2 is a hyperbola";
  EXPECT_LT(p.r2b, 0.06) << "that is steep near grazing";
}

}  // namespace
}  // namespace renderer
