#include "renderer/weave/unevenness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "renderer/scene/patch_curves.h"
#include "renderer/weave/initial_patch.h"
#include "renderer/weave/patch_measures.h"
#include "renderer/weave/woven_patch.h"
#include "tests/renderer/weave/relaxed_cloths.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

// Plain cloth of 8 x 8 yarns whose slubs are slow against the points and fast against the repeat.
Draft slubbed_cloth() {
  Draft draft = plain_cloth(1.2, 1.2, 0.5);
  draft.warp.threads.assign(8, 0);
  draft.weft.threads.assign(8, 1);
  draft.slubs = {.radius = 0.06, .length_mm = 1.5};
  return draft;
}

TEST(UnevennessTest, NoiseHasMeanZeroAndTheVarianceAndCorrelationThatWereAsked) {
  constexpr int kCount = 160, kSeeds = 2000;
  constexpr double kLength = 20;
  for (const double correlation : {0.5, 1.5, 4.0}) {
    double variance = 0, at_length = 0, at_half = 0;
    const int lag = static_cast<int>(std::lround(correlation / kLength * kCount));
    for (int seed = 0; seed < kSeeds; ++seed) {
      std::mt19937_64 random(static_cast<std::uint64_t>(seed));
      const std::vector<double> noise = closed_noise(kCount, kLength, correlation, random);
      double mean = 0;
      for (int i = 0; i < kCount; ++i) {
        const auto at = [&](int k) { return noise[static_cast<std::size_t>(k % kCount)]; };
        mean += at(i) / kCount;
        variance += at(i) * at(i) / kCount / kSeeds;
        at_length += at(i) * at(i + lag) / kCount / kSeeds;
        at_half += at(i) * at(i + lag / 2) / kCount / kSeeds;
      }
      EXPECT_NEAR(mean, 0, 1e-12);
    }
    // The cycle of length 0 is missing, whose share sqrt(pi) correlation / length the others have in its place.
    const double missing = std::sqrt(std::numbers::pi) * correlation / kLength;
    const auto expected = [&](double distance) {
      return (std::exp(-std::pow(distance / correlation, 2)) - missing) / (1 - missing);
    };
    std::printf(
        "correlation length %.1f mm of %.0f mm: variance %.3f, correlation there %.3f (%.3f), at half %.3f (%.3f)\n",
        correlation, kLength, variance, at_length / variance, expected(lag * kLength / kCount), at_half / variance,
        expected(lag / 2 * kLength / kCount));
    // 2000 lines of at least 20 / (4 sqrt(2 pi)) = 2 independent places: 2.2 % of the variance; four times that at most
    EXPECT_NEAR(variance, 1, 0.08);
    EXPECT_NEAR(at_length / variance, expected(lag * kLength / kCount), 0.04);
    EXPECT_NEAR(at_half / variance, expected(lag / 2 * kLength / kCount), 0.04);
  }
}

TEST(UnevennessTest, SlubsHaveTheDeviationAskedKeepTheMeanRadiusAndCloseOverTheRepeat) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Draft draft = slubbed_cloth();
    draft.unevenness.seed = seed;
    YarnPatch patch = initial_patch(draft);
    make_uneven(patch, draft);
    for (const Yarn& yarn : patch.yarns) {
      const auto knots = static_cast<double>(yarn.control_points.size());
      ASSERT_EQ(yarn.thickness.size(), yarn.control_points.size());
      EXPECT_EQ(yarn.radius_mm, 0.25);
      double mean = 0;
      const int places = 4 * static_cast<int>(knots);  // as many on each segment: the mean is that of the spline
      for (int i = 0; i < places; ++i) {
        const double thick = thickness(yarn, i / 4.0);
        EXPECT_NEAR(thickness(yarn, i / 4.0 + knots), thick, 1e-12);
        mean += thick / places;
        sum += (thick - 1) * (thick - 1);
        ++count;
      }
      EXPECT_NEAR(mean, 1, 1e-12);
    }
  }
  const double deviation = std::sqrt(sum / count);
  std::printf("radius along the yarn deviates by %.4f of it, asked 0.06\n", deviation);
  EXPECT_NEAR(deviation / 0.06, 1, 0.03);  // 960 lines of 9.6 mm: 1.5 % of the variance; 0.5 % of it are cut off
}

TEST(UnevennessTest, TheSameSeedGivesTheSameClothAndNoSlubsTheClothWithoutThem) {
  Draft draft = slubbed_cloth();
  const YarnPatch a = woven_patch(draft).patch, b = woven_patch(draft).patch;
  draft.unevenness.seed = 2;
  const YarnPatch other = woven_patch(draft).patch;
  draft.slubs = {.radius = 0, .length_mm = 3};
  const YarnPatch none = woven_patch(draft).patch, plain = relax(draft).patch;
  for (std::size_t i = 0; i < a.yarns.size(); ++i) {
    EXPECT_EQ(a.yarns[i].thickness, b.yarns[i].thickness);
    EXPECT_EQ(a.yarns[i].control_points, b.yarns[i].control_points);
    EXPECT_NE(a.yarns[i].thickness, other.yarns[i].thickness);
    EXPECT_TRUE(none.yarns[i].thickness.empty());
    EXPECT_EQ(none.yarns[i].control_points, plain.yarns[i].control_points);
  }
}

// Thick places lie higher over the yarns that they cross; made thick afterwards, they would overlap by the sum of both
// deviations.
TEST(UnevennessTest, SlubsComeToRestInContactWithTheThicknessOfEachPlace) {
  const Draft draft = slubbed_cloth();
  const RelaxedPatch cloth = woven_patch(draft);
  expect_at_rest(cloth);
  const YarnPatch even = relax(draft).patch;
  YarnPatch thickened = even;
  for (std::size_t i = 0; i < even.yarns.size(); ++i) thickened.yarns[i].thickness = cloth.patch.yarns[i].thickness;
  const double afterwards = least_gap(thickened);
  std::printf("overlap %.2f %% of the thinnest radius, gap %.4f mm; even yarns thickened afterwards %.4f mm\n",
              100 * cloth.report.overlap, cloth.patch.least_gap_mm, afterwards);
  EXPECT_LE(cloth.report.overlap, kMostOverlap);
  EXPECT_GE(cloth.patch.least_gap_mm, -kMostOverlap * 0.25);
  EXPECT_LT(afterwards, -0.01);
  EXPECT_LT(cloth.report.contact_forces_n.cwiseAbs().maxCoeff() / cloth.report.force_scale_n, 0.05);
}

TEST(UnevennessTest, SlubsAreDrawnWithTheRadiusOfEachPlace) {
  const YarnPatch patch = woven_patch(slubbed_cloth()).patch;
  const CurveSet curves = curves_of(patch, {2, 1}, 1);  // weft yarns, along x
  const Yarn& first = *std::find_if(patch.yarns.begin(), patch.yarns.end(), [](const Yarn& y) { return !y.warp; });
  const std::size_t count = first.control_points.size();
  for (std::size_t k = 0; k < 2 * count; ++k)  // the curve starts with the point before the border
    EXPECT_FLOAT_EQ(curves.control_points[k].w(), static_cast<float>(0.25 * first.thickness[(k + count - 1) % count]));
}

TEST(UnevennessTest, ShadesChangeAlongAYarnInPiecesOfTheMeanLengthAsked) {
  Draft draft = slubbed_cloth();
  draft.slubs = {.shade_mm = 2};
  draft.unevenness.shades = 4;
  double changes = 0, length = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    draft.unevenness.seed = seed;
    YarnPatch patch = initial_patch(draft);
    make_uneven(patch, draft);
    for (const Yarn& yarn : patch.yarns) {
      ASSERT_EQ(yarn.threads.size(), yarn.control_points.size());
      for (std::size_t k = 0; k < yarn.threads.size(); ++k) {
        EXPECT_EQ(yarn.threads[k] / 4, yarn.warp ? 0 : 1);
        changes += yarn.threads[k] != yarn.threads[(k + 1) % yarn.threads.size()];
      }
      length += spline_length(center_line(patch, yarn));
    }
  }
  // Every fourth piece has the shade of the one before, and one in some 16 begins where another does.
  std::printf("a shade changes every %.2f mm\n", length / changes);
  EXPECT_NEAR(length / changes, 2 / 0.75, 0.35);

  const YarnPatch patch = woven_patch(draft).patch;
  std::size_t segments = 0, all = 0;
  for (const int thread : threads_of(patch)) segments += curves_of(patch, {1, 1}, thread).segments.size();
  for (const Yarn& yarn : patch.yarns) all += yarn.control_points.size();
  EXPECT_EQ(segments, all);
}

TEST(UnevennessTest, PliesTurnUnevenlyAndStillWholeTimes) {
  Draft draft = slubbed_cloth();
  draft.slubs = {.radius = 0.05, .twist = 0.15, .length_mm = 1.5};
  draft.plies = {.count = 2, .turns_per_mm = 0.9};
  YarnPatch patch = initial_patch(draft);
  make_uneven(patch, draft);
  const YarnPatch twisted = with_plies(patch, draft.plies);
  const Yarn &yarn = patch.yarns[0], &ply = twisted.yarns[0];
  const PeriodicSpline center = center_line(patch, yarn), line = center_line(twisted, ply);
  const auto knots = static_cast<double>(yarn.control_points.size()),
             fine = static_cast<double>(ply.control_points.size());
  double turned = 0, least = 1e9, most = 0;
  Vector3d before = Vector3d::Zero();
  constexpr int kSteps = 400;
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    const Vector3d arm = spline_value(line, share * fine) - spline_value(center, share * knots),
                   along = spline_value(center, share * knots, 1).normalized();
    if (i > 0) {
      const double angle = std::abs(std::atan2(before.cross(arm).dot(along), before.dot(arm)));
      turned += angle;
      least = std::min(least, angle);
      most = std::max(most, angle);
    }
    before = arm;
    // Arm and ply fill the yarn where it is thick and where it is thin.
    EXPECT_NEAR(arm.norm() + ply.radius_mm * thickness(ply, share * fine), 0.25 * thickness(yarn, share * knots),
                0.003);
  }
  std::printf("%.3f turns; from %.2f to %.2f of the mean per step\n", turned / (2 * std::numbers::pi),
              least * kSteps / turned, most * kSteps / turned);
  EXPECT_NEAR(turned / (2 * std::numbers::pi), std::round(0.9 * spline_length(center)), 0.01);
  EXPECT_LT(least * kSteps / turned, 0.9);
  EXPECT_GT(most * kSteps / turned, 1.1);
  EXPECT_TRUE(ply.twist.empty());
}

}  // namespace
}  // namespace renderer
