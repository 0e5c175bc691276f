#include "renderer/scattering/fiber.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <vector>

#include "renderer/scattering/degree.h"
#include "tests/places.h"
#include "tests/renderer/scattering/scattering_statistics.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

std::vector<std::vector<double>> reference_rows() {
  std::ifstream file(FIXTURES_DIR "/reference/single_fiber_bcsdf.csv");
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

TEST(FiberTest, AgreesWithAllRowsOfTheReferenceTable) {
  const auto rows = reference_rows();
  ASSERT_EQ(rows.size(), 800u);
  for (const auto& r : rows) {
    const FiberModel<double> model(
        {.eta = r[1], .sigma_a = {r[2], r[3], r[4]}, .beta_m = r[5], .beta_n = r[6], .tilt_rad = r[7] * kDegree});
    const auto value = model.lobes_at(r[0], {r[8], r[9], r[10]}).evaluate({r[11], r[12], r[13]});
    // The table's directions have 12 digits; narrow lobes amplify their rounding, the formula itself agrees to 1e-9.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value.f_cos[c] / r[14 + static_cast<std::size_t>(c)], 1, 1e-6);
    EXPECT_NEAR(value.pdf / r[17], 1, 1e-6);
  }
}

TEST(FiberTest, FloatAgreesWithDouble) {
  for (const auto& r : reference_rows()) {
    const FiberModel<float> model({static_cast<float>(r[1]), Vector3d(r[2], r[3], r[4]).cast<float>(),
                                   static_cast<float>(r[5]), static_cast<float>(r[6]),
                                   static_cast<float>(r[7] * kDegree)});
    const auto value = model.lobes_at(static_cast<float>(r[0]), Vector3d(r[8], r[9], r[10]).cast<float>())
                           .evaluate(Vector3d(r[11], r[12], r[13]).cast<float>());
    // Rounding of angles (1e-7 rad), divided by the narrowest width of the table (about 1e-3 rad far in the tails).
    const double tolerance = 2e-3 * r[17] + 1e-6;
    EXPECT_NEAR(static_cast<double>(value.pdf), r[17], tolerance);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(static_cast<double>(value.f_cos[c]), r[14 + static_cast<std::size_t>(c)], tolerance);
  }
}

TEST(FiberTest, WhiteFurnaceOfTheWholeFunctionIsOne) {
  constexpr int kTheta = 300, kPhi = 600;
  const FiberModel<double> model({.beta_m = 0.25, .beta_n = 0.3, .tilt_rad = 0.03});
  const auto lobes = model.lobes_at(0.6, viewing_direction(0.5, 0.6));
  double sum = 0;
  for (int i = 0; i < kTheta; ++i) {
    const double theta = std::numbers::pi * ((i + 0.5) / kTheta - 0.5);
    for (int j = 0; j < kPhi; ++j)
      sum += lobes.evaluate(direction(theta, 2 * std::numbers::pi * j / kPhi)).f_cos[1] * std::cos(theta);
  }
  EXPECT_NEAR(sum * (std::numbers::pi / kTheta) * (2 * std::numbers::pi / kPhi), 1, 1e-3);
}

TEST(FiberTest, AbsorptionTakesEnergyFromEveryLobeButTheReflection) {
  const FiberModel<double> clear({}), dyed({.sigma_a = {0.1, 0.3, 0.8}});
  const auto a = clear.lobes_at(0.2, viewing_direction(0.3, 0.2)), b = dyed.lobes_at(0.2, viewing_direction(0.3, 0.2));
  for (int c = 0; c < 3; ++c) {
    EXPECT_DOUBLE_EQ(a.attenuation(0, c), b.attenuation(0, c));
    for (int p = 1; p < 4; ++p) EXPECT_GT(a.attenuation(p, c), b.attenuation(p, c));
  }
}

TEST(FiberTest, MirroringTheCrossSectionMirrorsTheScattering) {
  const FiberModel<double> model({.sigma_a = {0.1, 0.3, 0.8}});
  const auto value = model.lobes_at(0.4, viewing_direction(0.2, 0.4)).evaluate(direction(-0.3, 1.1));
  const auto mirrored =
      model.lobes_at(-0.4, viewing_direction(0.2, -0.4)).evaluate(direction(-0.3, std::numbers::pi - 1.1));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value.f_cos[c], mirrored.f_cos[c], 1e-14);
}

TEST(FiberTest, ReflectionPeaksWhereAMirrorWouldSendTheLight) {
  const FiberModel<double> model({.sigma_a = {50, 50, 50}, .beta_m = 0.05, .beta_n = 0.05});
  const double h = 0.5, theta = 0.3;
  const auto lobes = model.lobes_at(h, viewing_direction(theta, h));
  // The surface normal is the local z axis: a mirror turns (x, y, z) into (-x, -y, z).
  const Vector3d wo = viewing_direction(theta, h), mirror(-wo.x(), -wo.y(), wo.z());
  const double peak = lobes.evaluate(mirror).f_cos[0];
  for (double delta : {-0.05, 0.05}) {
    EXPECT_LT(lobes.evaluate(direction(std::asin(mirror.x()) + delta, std::atan2(mirror.z(), mirror.y()))).f_cos[0],
              peak);
    EXPECT_LT(lobes.evaluate(direction(std::asin(mirror.x()), std::atan2(mirror.z(), mirror.y()) + delta)).f_cos[0],
              peak);
  }
}

}  // namespace
}  // namespace renderer
