#include "calibration/light/spectralon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "calibration/sensor/degree.h"
#include "tests/places.h"

namespace calibration {
namespace {

double factor(double theta_i, double theta_e, double phi) {
  return 1 + kPublishedDroop *
                 droop_shape(std::cos(theta_i * kDegree), std::cos(theta_e * kDegree), std::cos(phi * kDegree));
}

TEST(Spectralon, ThePublishedPanelIsThatOfTheReferenceTable) {
  std::ifstream table(std::string(FIXTURES_DIR) + "/reference/spectralon/peer_brf_table_550nm.txt");
  std::string line;
  double phi = -1, theta_i = -1;
  int compared = 0;
  const double to_8_degrees = 1.0283;
  while (std::getline(table, line)) {
    if (line.starts_with("phi ")) phi = std::stod(line.substr(4));
    if (phi < 0 || line.size() < 8 || line[0] != 'i' || !std::isdigit(static_cast<unsigned char>(line[1]))) continue;
    theta_i = std::stod(line.substr(1, 2));
    std::istringstream row(line.substr(4));
    double value = 0;
    // three decimals are printed, scaled by a droop known to three
    for (double theta_e = 0; row >> value; theta_e += 10, ++compared)
      EXPECT_NEAR(factor(theta_i, theta_e, phi), value / to_8_degrees, 0.002)
          << theta_i << ' ' << theta_e << ' ' << phi;
  }
  EXPECT_EQ(compared, 3 * 64);
}

TEST(Spectralon, TheCertifiedReflectanceIsThatOfLightAtEightDegrees) {
  constexpr int kRings = 90, kTurns = 24;
  double sum = 0;
  for (int ring = 0; ring < kRings; ++ring)
    for (int turn = 0; turn < kTurns; ++turn) {
      const double theta_e = (ring + 0.5) * 90 / kRings;
      sum += factor(8, theta_e, (turn + 0.5) * 360 / kTurns) * 2 * std::sin(theta_e * kDegree) *
             std::cos(theta_e * kDegree) * (90.0 / kRings * kDegree) / kTurns;
    }
  EXPECT_NEAR(sum, 1.0, 0.001);  // how well between 0 and 10 degrees is interpolated
}

TEST(Spectralon, DroopIsTheLossBetweenFacingAndSixtyDegrees) {
  EXPECT_NEAR(droop_shape(1, 1, 1) - droop_shape(0.5, 1, 1), 1.0, 0.01);
}

}  // namespace
}  // namespace calibration
