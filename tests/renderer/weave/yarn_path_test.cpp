#include "renderer/weave/yarn_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "renderer/scattering/degree.h"

namespace renderer {
namespace {

struct PeirceRow {
  double pitch_over_d, angle_deg, length_over_d;
};

// Square plain cloth, D = sum of both diameters [Peirce 1937].
const PeirceRow kPeirce[]{{0.8660254, 60.00, 1.0472}, {0.9, 47.18, 1.0684}, {1.0, 36.87, 1.1435}, {1.25, 26.17, 1.3581},
                          {1.5, 20.80, 1.5877},       {2.0, 14.98, 2.0642}, {3.0, 9.73, 3.0422}};

TEST(YarnPathTest, SquareClothHasTheAnglesAndLengthsOfPeircesTable) {
  for (const PeirceRow& row : kPeirce) {
    const double pitch = std::max(row.pitch_over_d, std::sqrt(0.75));
    const HalfWave wave = taut_half_wave(pitch, 0.25, 0.25);  // D = 1, so each system's crown is D / 4
    EXPECT_NEAR(wave.angle_rad / kDegree, row.angle_deg, row.pitch_over_d < 0.87 ? 0.02 : 0.006)
        << pitch;                                                         // printed digits; at
    EXPECT_NEAR(2 * wave.length_mm(), row.length_over_d, 6e-5) << pitch;  // the jam the angle has an infinite slope
  }
}

TEST(YarnPathTest, TheTautHalfWaveObeysPeircesTwoEquations) {
  for (double crown : {0.05, 0.2, 0.31}) {
    const double other = 0.4 - crown, pitch = 0.83;
    const HalfWave wave = taut_half_wave(pitch, crown, other);
    const double l = 2 * wave.length_mm(), theta = wave.angle_rad, contact = 0.4;  // Peirce's D / 2
    EXPECT_NEAR(pitch, (l - 2 * contact * theta) * std::cos(theta) + 2 * contact * std::sin(theta), 1e-12);
    EXPECT_NEAR(2 * crown, (l - 2 * contact * theta) * std::sin(theta) + 2 * contact * (1 - std::cos(theta)), 1e-12);
  }
}

TEST(YarnPathTest, TheHalfWaveEndsInTheMiddleAtHeightZero) {
  for (double pitch : {0.55, 0.8, 1.1, 4.0}) {  // jammed and free
    const HalfWave wave = half_wave(pitch, 0.3, 0.2);
    const Eigen::Vector2d end = wave.at(wave.length_mm()), start = wave.at(0);
    EXPECT_NEAR(end.x(), pitch / 2, 1e-12);
    EXPECT_NEAR(end.y(), 0, 1e-12);
    EXPECT_EQ(start.y(), 0.3);
  }
}

TEST(YarnPathTest, SquareClothSplitsTheHeightsEvenlyAndUnevenSettsFollowCrimpInterchange) {
  const YarnSystem open{.diameter_mm = 0.5, .pitch_mm = 2.0}, wider{.diameter_mm = 0.5, .pitch_mm = 2.4};
  const CrownHeights square = split_heights(open, open);
  EXPECT_DOUBLE_EQ(square.warp_mm, 0.25);
  EXPECT_DOUBLE_EQ(square.weft_mm, 0.25);
  const CrownHeights uneven = split_heights(open, wider);  // the warp has the longer way from weft to weft: it bends
  EXPECT_NEAR(uneven.warp_mm / uneven.weft_mm, std::pow(1.2, 3), 1e-12);
  const YarnSystem thick{.diameter_mm = 0.8, .pitch_mm = 2.0};
  const CrownHeights stiff = split_heights(open, thick);
  EXPECT_NEAR(stiff.warp_mm / stiff.weft_mm, std::pow(0.8 / 0.5, 2), 1e-12);
  EXPECT_DOUBLE_EQ(stiff.warp_mm + stiff.weft_mm, 0.65);  // yarns touch
}

TEST(YarnPathTest, ATightWarpLeavesTheWeftStraightEnoughThatNoYarnIsCutInto) {
  const YarnSystem tight{.diameter_mm = 0.5, .pitch_mm = 0.5}, wide{.diameter_mm = 0.5, .pitch_mm = 1.0};
  const CrownHeights crown = split_heights(tight, wide);
  EXPECT_NEAR(half_wave(1.0, crown.warp_mm, crown.weft_mm).radius_mm, 0.5, 1e-12);
  EXPECT_NEAR(half_wave(0.5, crown.weft_mm, crown.warp_mm).radius_mm, 0.5, 1e-12);
  EXPECT_LT(crown.weft_mm, 0.07);
}

TEST(YarnPathTest, WhereCrimpInterchangeWouldPressYarnsIntoEachOtherTheNearestFreeSplitIsTaken) {
  const YarnSystem thick{.diameter_mm = 0.7, .pitch_mm = 0.7}, thin{.diameter_mm = 0.3, .pitch_mm = 1.0};
  const CrownHeights crown = split_heights(thick, thin);  // interchange alone: 0.174 mm for the warp
  EXPECT_NEAR(crown.warp_mm, std::sqrt(0.5 * 0.5 - 0.35 * 0.35), 1e-12);
  EXPECT_NEAR(half_wave(0.7, crown.weft_mm, crown.warp_mm).straight_mm, 0, 1e-6);  // at the jam; a root of rounding
  EXPECT_NEAR(half_wave(0.7, crown.weft_mm, crown.warp_mm).radius_mm, 0.5, 1e-6);
  EXPECT_DOUBLE_EQ(split_heights(thin, thick).weft_mm, crown.warp_mm);
}

double crimp_of(const HalfWave& wave, double pitch) {
  return 2 * wave.length_mm() / pitch - 1;
}

TEST(YarnPathTest, InOpenClothTheTautCrimpIsThatOfAStringAndTheWovenOneThatOfAClampedBeam) {
  const double pitch = 40, rise = 0.5, unit = rise * rise / (pitch * pitch);
  EXPECT_NEAR(crimp_of(taut_half_wave(pitch, rise / 2, rise / 2), pitch) / unit, 0.5,
              0.01);                                                                       // plus about D / (2 p) of it
  EXPECT_NEAR(crimp_of(half_wave(pitch, rise / 2, rise / 2), pitch) / unit, 0.6, 0.0002);  // plus (h / p)^2 of it
}

TEST(YarnPathTest, TheWovenPathIsNeverShorterNorMoreSharplyBentThanTheTautOne) {
  double previous = 0;
  for (double pitch = 0.87; pitch < 5; pitch *= 1.01) {
    const HalfWave taut = taut_half_wave(pitch, 0.25, 0.25), woven = half_wave(pitch, 0.25, 0.25);
    EXPECT_GE(woven.length_mm(), taut.length_mm() - 1e-12) << pitch;
    EXPECT_GE(woven.radius_mm, taut.radius_mm - 1e-12) << pitch;
    EXPECT_LE(crimp_of(woven, pitch), 1.2 * crimp_of(taut, pitch)) << pitch;  // 0.6 / 0.5
    EXPECT_GT(woven.length_mm(), previous) << pitch;
    previous = woven.length_mm();
  }
  EXPECT_EQ(half_wave(0.9, 0.25, 0.25).radius_mm, 0.5);  // tight cloth: on the crossing yarn's section
  EXPECT_EQ(half_wave(1.0, 0.25, 0.25).radius_mm, 0.5);
  EXPECT_GT(half_wave(1.25, 0.25, 0.25).radius_mm, 0.5);
}

TEST(YarnPathTest, AStraightYarnStaysStraight) {
  const HalfWave wave = half_wave(1.2, 0, 0.5);
  EXPECT_NEAR(wave.length_mm(), 0.6, 1e-12);
  EXPECT_NEAR(wave.at(0.4).y(), 0, 1e-12);
}

TEST(YarnPathTest, FloatsAreFlatAndCrossingsAreEvenlySpaced) {
  const HalfWave wave = half_wave(1.0, 0.25, 0.25);
  const auto path = yarn_path({true, true, true, false}, 1.0, wave);
  ASSERT_EQ(path.size(), 4u * kPointsPerCrossing);
  EXPECT_NEAR(path[0].x(), 0, 1e-12);
  EXPECT_NEAR(path[0].y(), 0, 1e-12);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& crossing = path[kPointsPerCrossing * i + kPointsPerCrossing / 2];
    EXPECT_EQ(crossing, Eigen::Vector2d(static_cast<double>(i) + 0.5, i < 3 ? 0.25 : -0.25));
  }
  for (std::size_t k = kPointsPerCrossing / 2; k <= 2 * kPointsPerCrossing + kPointsPerCrossing / 2; ++k)
    EXPECT_EQ(path[k].y(), 0.25);
}

}  // namespace
}  // namespace renderer
