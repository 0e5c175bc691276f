// Line art as embroidery: where the needle goes follows from what each test draws.
#include "renderer/embroidery/digitise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace renderer {
namespace {

using Eigen::Vector2d;

constexpr std::array<unsigned char, 3> kRed{255, 0, 0}, kBlue{0, 0, 255};

ArtLine drawn(const std::vector<Vector2d>& corners, double width_mm = 0.3) {
  ArtLine line{.srgb = kRed, .width_mm = width_mm, .points = {corners.front()}};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vector2d step = corners[i] - corners[i - 1];
    const double parts = std::ceil(step.norm() / kLineStep_mm);
    for (int k = 1; k <= static_cast<int>(parts); ++k) line.points.emplace_back(corners[i - 1] + k / parts * step);
  }
  return line;
}

std::vector<Vector2d> needle(const ArtLine& line) {
  const Motif motif = digitise({.name = "line", .lines = {line}}, "motif");
  EXPECT_EQ(motif.runs.size(), 1U);
  return motif.runs.front().needle_points;
}

double longest(const std::vector<Vector2d>& points) {
  double most = 0;
  for (std::size_t i = 1; i < points.size(); ++i) most = std::max(most, (points[i] - points[i - 1]).norm());
  return most;
}

TEST(Digitise, ALineIsStitchesOfALikeLength) {
  for (const double length : {1.0, 10.03, 12.0, 30.0}) {
    const std::vector<Vector2d> points = needle(drawn({{10, -20}, {10 + length, -20}}));
    EXPECT_EQ(points.size(), 1 + static_cast<std::size_t>(std::ceil(length / 2.4))) << length;
    EXPECT_LT((points.front() - Vector2d(10, -20)).norm(), 1e-9);
    EXPECT_LT((points.back() - Vector2d(10 + length, -20)).norm(), 1e-9);
    for (std::size_t i = 1; i < points.size(); ++i) {
      EXPECT_NEAR(points[i].y(), -20, 1e-9);
      EXPECT_GT(points[i].x() - points[i - 1].x(), std::min(1.0, length) - 1e-9) << length << ' ' << i;
    }
    EXPECT_LE(longest(points), 2.5) << length;
  }
}

// The length of stitches is what ends them on the larger circle, their sag on the smaller one.
TEST(Digitise, CirclesAreFollowedWithinATenthOfAMillimetre) {
  for (const double radius : {7.0, 2.5}) {
    std::vector<Vector2d> circle;
    for (int k = 0; k <= 440; ++k) {
      const double angle = 2 * std::numbers::pi * k / 440;
      circle.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    const std::vector<Vector2d> points = needle({.srgb = kRed, .width_mm = 0.3, .points = circle});
    for (std::size_t i = 1; i < points.size(); ++i) {
      EXPECT_NEAR(points[i].norm(), radius, 1e-6);
      EXPECT_GT(((points[i] + points[i - 1]) / 2).norm(), radius - 0.121) << radius;
    }
    EXPECT_LT((points.front() - points.back()).norm(), 1e-6);
    EXPECT_LE(longest(points), 2.5);
  }
}

TEST(Digitise, CornersAreNeedlePoints) {
  const std::vector<Vector2d> corners{{1, -2}, {4.7, -2}, {4.7, -7.3}, {1, -7.3}};
  const std::vector<Vector2d> points = needle(drawn({corners[0], corners[1], corners[2], corners[3], corners[0]}));
  for (const Vector2d& corner : corners)
    EXPECT_TRUE(std::ranges::any_of(points, [&](const Vector2d& p) { return (p - corner).norm() < 1e-9; }))
        << corner.transpose();
}

TEST(Digitise, AWideStrokeIsSatinAsWideAsItself) {
  const std::vector<Vector2d> points = needle(drawn({{5, -5}, {25, -5}}, 3));
  EXPECT_NEAR(static_cast<double>(points.size()), 2 * 20 / 0.35, 2);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(points[i].y(), i % 2 == 0 ? -3.5 : -6.5, 1e-9);
}

TEST(Digitise, NeighbouringLinesOfOneColourShareAThread) {
  std::vector<ArtLine> lines(4, drawn({{0, 0}, {9, 0}}));
  lines[2].srgb = kBlue;
  const Motif motif = digitise({.name = "a rose", .lines = lines}, "motif");
  EXPECT_EQ(motif.name, "a rose");
  ASSERT_EQ(motif.threads.size(), 3U);
  EXPECT_EQ(motif.threads[0].srgb, kRed);
  EXPECT_EQ(motif.threads[1].srgb, kBlue);
  ASSERT_EQ(motif.runs.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(motif.runs[i].thread, i < 2 ? 0 : i - 1) << i;
}

TEST(Digitise, MoreThanAMillionStitchesAreRefusedInOneLine) {
  const std::vector<ArtLine> lines(20, drawn({{0, 0}, {9000, 0}}, 3));
  try {
    digitise({.name = "long", .lines = lines}, "motif.svg");
    FAIL() << "nothing was refused";
  } catch (const std::runtime_error& refused) {
    const std::string line = refused.what();
    EXPECT_TRUE(line.starts_with("motif.svg: ") && line.find("million stitches") != std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace renderer
