#include "renderer/embroidery/stitch_curves.h"

#include <gtest/gtest.h>

#include <cmath>

namespace renderer {
namespace {

using Eigen::Vector2d;

Motif stitches(const std::vector<std::vector<Vector2d>>& runs) {
  Motif motif{.name = "test", .threads = {{}, {}}, .runs = {}};
  for (std::size_t i = 0; i < runs.size(); ++i)
    motif.runs.push_back({.thread = static_cast<int>(i % 2), .needle_points = runs[i]});
  return motif;
}

double height_at(const CurveSet& curves, const Vector2d& place) {
  double nearest = 1e9, height = 0;
  for (const Eigen::Vector4f& point : curves.control_points) {
    const double away = (point.head<2>().cast<double>() - place).norm();
    if (away < nearest) nearest = away, height = point.z();
  }
  return height;
}

TEST(Motif, MeasuresCountStitchesLengthsAndExtents) {
  const Motif motif = stitches({{{0, 0}, {3, 4}, {3, -1}}, {{10, 10}}});
  const MotifMeasures found = measure(motif);
  EXPECT_EQ(found.stitches, 2);
  EXPECT_EQ(found.stitches_of_threads, (std::vector<int>{2, 0}));
  EXPECT_DOUBLE_EQ(found.lengths_mm[0], 10);
  EXPECT_EQ(found.low, Vector2d(0, -1));
  EXPECT_EQ(found.high, Vector2d(10, 10));
}

TEST(Motif, CutsBeginANewRunAndJumpsDoNot) {
  MotifRecorder recorder;
  recorder.stitch({1, 0});
  recorder.jump({1, 0});
  recorder.stitch({1, 0});
  recorder.trim();
  recorder.jump({5, 0});
  recorder.stitch({0, 1});
  recorder.next_thread();
  recorder.stitch({0, 1});
  const Motif& motif = recorder.motif();
  ASSERT_EQ(motif.runs.size(), 3U);
  EXPECT_EQ(motif.runs[0].needle_points, (std::vector<Vector2d>{{1, 0}, {3, 0}}));
  EXPECT_EQ(motif.runs[1].needle_points, (std::vector<Vector2d>{{8, 1}}));
  EXPECT_EQ(motif.runs[2].thread, 1);
}

TEST(StitchCurves, AStitchLiesOnTheClothAndItsEndsInIt) {
  const StitchCurves made = stitch_curves(stitches({{{0, 0}, {6, 0}}}), 0.4);
  EXPECT_TRUE(made.threads[1].segments.empty());
  EXPECT_NEAR(height_at(made.threads[0], {3, 0}), 0.2, 1e-6);
  EXPECT_NEAR(height_at(made.threads[0], {0, 0}), -0.2, 1e-6);
  EXPECT_NEAR(height_at(made.threads[0], {6, 0}), -0.2, 1e-6);
  EXPECT_NEAR(made.top_mm, 0.4, 1e-6);
}

TEST(StitchCurves, AThreadThatCrossesAnotherLiesOnItAndSpansTaut) {
  const StitchCurves made = stitch_curves(stitches({{{0, 0}, {6, 0}}, {{3, -3}, {3, 3}}}), 0.4);
  EXPECT_NEAR(height_at(made.threads[1], {3, 0}), 0.2 + kLayerHeight * 0.4, 0.02);
  // Straight from the cloth up to the crossing: halfway it is half as high above the cloth's surface.
  const double halfway = height_at(made.threads[1], {3, 1.5});
  EXPECT_GT(halfway, 0.25);
  EXPECT_LT(halfway, 0.42);
  EXPECT_NEAR(height_at(made.threads[0], {3, 0}), 0.2, 1e-6) << "what lies below stays";
}

TEST(StitchCurves, SatinStitchesSideBySideDoNotClimbOnEachOther) {
  const auto top_of = [](int count) {
    std::vector<Vector2d> satin;
    for (int i = 0; i < count; ++i) satin.push_back({i % 2 == 0 ? 0.0 : 5.0, 0.35 * i});
    return stitch_curves(stitches({satin}), 0.4).top_mm;
  };
  EXPECT_LT(top_of(10), 0.4 + 2 * kLayerHeight * 0.4);  // where they share a needle point they cross
  EXPECT_NEAR(top_of(200), top_of(10), 0.03);
}

TEST(StitchCurves, WhatCannotBeDrawnIsOneLine) {
  EXPECT_THROW(stitch_curves(stitches({{{0, 0}, {6, 0}}}), 0), std::runtime_error);
  EXPECT_THROW(stitch_curves(stitches({{{0, 0}}}), 0.4), std::runtime_error);
}

}  // namespace
}  // namespace renderer
