// Line art as embroidery: where the needle goes follows from what each test draws.
#include "renderer/embroidery/digitise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
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

// Whether a place is inside of outlines, by the angles under which it sees them.
bool inside(const std::vector<std::vector<Vector2d>>& area, const Vector2d& at) {
  double winding = 0;
  for (const auto& outline : area)
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vector2d a = outline[i] - at, b = outline[(i + 1) % outline.size()] - at;
      winding += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
  return std::abs(winding) > std::numbers::pi;
}

// Rings with a hole, drawn at random: the stitches lie within, along the direction, and cover the ring evenly.
TEST(Digitise, AFilledShapeIsRowsOfStitchesAlongItsDirection) {
  constexpr unsigned kSeed = 20261202;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  for (int trial = 0; trial < 5; ++trial) {
    const double phase = between(0, 6), along = between(-3, 3);
    const Vector2d middle(between(-40, 40), between(-40, 40));
    const int lobes = static_cast<int>(between(2, 6));
    ArtLine shape{.srgb = kRed, .along_rad = along};
    for (const double size : {1.0, -0.4}) {  // the hole turns the other way
      std::vector<Vector2d>& outline = shape.area.emplace_back();
      for (int k = 0; k < 720; ++k) {
        const double angle = (size < 0 ? -1 : 1) * 2 * std::numbers::pi * k / 720;
        const double radius = std::abs(size) * (14 + 3 * std::cos(lobes * angle + phase));
        outline.emplace_back(middle + radius * Vector2d(std::cos(angle), std::sin(angle)));
      }
    }
    const Motif motif = digitise({.name = "ring", .lines = {shape}}, "motif");
    const Vector2d direction(std::cos(along), std::sin(along));
    double sewn_mm = 0, area_mm2 = 0;
    int outside = 0, stitches = 0;
    for (const StitchRun& run : motif.runs)
      for (std::size_t i = 1; i < run.needle_points.size(); ++i) {
        const Vector2d stitch = run.needle_points[i] - run.needle_points[i - 1];
        EXPECT_LT(stitch.norm(), 4.7);
        const bool in_row = std::abs(direction.x() * stitch.y() - direction.y() * stitch.x()) < 1e-6;
        if (!in_row) continue;  // from one row to the next, along the outline
        sewn_mm += stitch.norm(), ++stitches;
        outside += !inside(shape.area, (run.needle_points[i] + run.needle_points[i - 1]) / 2);
      }
    constexpr double kCell_mm = 0.3;
    for (double x = -18; x < 18; x += kCell_mm)
      for (double y = -18; y < 18; y += kCell_mm)
        area_mm2 += kCell_mm * kCell_mm * inside(shape.area, middle + Vector2d(x, y));
    EXPECT_EQ(outside, 0) << "of " << stitches;
    EXPECT_NEAR(sewn_mm * 0.35 / area_mm2, 1, 0.02);
  }
}

TEST(Digitise, AShapeWithoutADirectionIsFilledAlongItsLongerSide) {
  ArtLine shape{.srgb = kRed, .area = {{{0, 0}, {20, 20}, {19, 21}, {-1, 1}}}};
  const Motif motif = digitise({.name = "bar", .lines = {shape}}, "motif");
  ASSERT_EQ(motif.runs.size(), 1U);
  const std::vector<Vector2d>& points = motif.runs[0].needle_points;
  EXPECT_GT(longest(points), 3.5);
  const Vector2d first = points[1] - points[0];
  EXPECT_NEAR(std::abs(first.x()), std::abs(first.y()), 1e-6);
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
