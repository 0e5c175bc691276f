#include "renderer/scene/patch_curves.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "renderer/weave/initial_patch.h"

namespace renderer {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4f;

Draft two_colours() {
  Draft draft = twill_draft(2, 2);
  draft.warp.threads = {0, 1};
  draft.weft.threads = {2};
  draft.weft.pitch_mm = 1.1;
  return draft;
}

Vector3d point_of(const CurveSet& set, std::uint32_t first, double u) {
  std::vector<Vector3d> four;
  for (std::uint32_t i = 0; i < 4; ++i) four.push_back(set.control_points[first + i].head<3>().cast<double>());
  const double v = 1 - u;
  return (v * v * v * four[0] + (4 - 6 * u * u + 3 * u * u * u) * four[1] + (4 - 6 * v * v + 3 * v * v * v) * four[2] +
          u * u * u * four[3]) /
         6;
}

// How far outside the column [-margin, period + margin]^2 the surface of a segment stays, by sampling; negative: it
// enters.
double distance_to_column(const YarnPatch& patch, const CurveSet& set, std::uint32_t first, const Vector3d& offset,
                          double margin) {
  double least = 1e9;
  for (int i = 0; i <= 16; ++i) {
    const Vector3d p = point_of(set, first, i / 16.0) + offset;
    const double dx = std::max({-margin - p.x(), p.x() - patch.period_x_mm - margin, 0.0});
    const double dy = std::max({-margin - p.y(), p.y() - patch.period_y_mm - margin, 0.0});
    least = std::min(least, std::hypot(dx, dy) - static_cast<double>(set.control_points[first].w()));
  }
  return least;
}

bool contains_segment(const CurveSet& set, const CurveSet& other, std::uint32_t first, const Vector3d& offset) {
  return std::any_of(set.segments.begin(), set.segments.end(), [&](std::uint32_t mine) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      const Vector3d a = set.control_points[mine + i].head<3>().cast<double>();
      const Vector3d b = other.control_points[first + i].head<3>().cast<double>() + offset;
      if ((a - b).norm() > 1e-5) return false;  // rounding of single precision over a few tiles
    }
    return true;
  });
}

TEST(PatchCurvesTest, ThreadsOfThePatchAreListedOnce) {
  EXPECT_EQ(threads_of(initial_patch(two_colours())), (std::vector<int>{0, 1, 2}));
  EXPECT_TRUE(curves_of(initial_patch(two_colours()), {1, 1}, 7).segments.empty());
}

TEST(PatchCurvesTest, ASheetHasEveryYarnInOnePieceFromBorderToBorder) {
  const YarnPatch patch = initial_patch(two_colours());
  const double width = 3 * patch.period_x_mm, height = 2 * patch.period_y_mm;
  std::size_t curves = 0;
  for (int thread : {0, 1, 2}) {
    const CurveSet sheet = curves_of(patch, {3, 2}, thread);
    for (std::size_t s = 0; s < sheet.segments.size(); ++s) {
      const std::uint32_t first = sheet.segments[s];
      ASSERT_LT(first + 3, sheet.control_points.size());
      if (s > 0 && first == sheet.segments[s - 1] + 1) continue;
      ++curves;
      std::size_t last = s;
      while (last + 1 < sheet.segments.size() && sheet.segments[last + 1] == sheet.segments[last] + 1) ++last;
      const Vector3d run = point_of(sheet, sheet.segments[last], 1) - point_of(sheet, first, 0);
      const Vector3d expected = thread == 2 ? Vector3d(width, 0, 0) : Vector3d(0, height, 0);
      EXPECT_LT((run - expected).norm(), 1e-5);
      EXPECT_NEAR(point_of(sheet, first, 0)[thread == 2 ? 0 : 1], 0, 1e-6);
    }
  }
  EXPECT_EQ(curves, 3u * 4u + 2u * 4u);
}

TEST(PatchCurvesTest, ASheetRepeatsItselfWithThePeriod) {
  const YarnPatch patch = initial_patch(two_colours());
  const CurveSet one = curves_of(patch, {1, 1}, 0), sheet = curves_of(patch, {3, 3}, 0);
  EXPECT_EQ(sheet.segments.size(), 9 * one.segments.size());
  for (std::uint32_t first : one.segments) {
    for (int x : {0, 2})
      for (int y : {0, 2})
        EXPECT_TRUE(contains_segment(sheet, one, first, {x * patch.period_x_mm, y * patch.period_y_mm, 0}));
  }
}

TEST(PatchCurvesTest, ACellHoldsEverySegmentOfTheInfiniteClothThatReachesItAndNoFarOnes) {
  Draft small = plain_draft();
  for (const YarnPatch& patch : {initial_patch(two_colours()), initial_patch(small)}) {
    for (double margin : {0.0, 0.3, 2.5}) {  // the last reaches beyond the next tile of the small patch
      for (int thread : threads_of(patch)) {
        const CurveSet cell = cell_curves_of(patch, thread, margin), sheet = curves_of(patch, {7, 7}, thread);
        const Vector3d offset(-3 * patch.period_x_mm, -3 * patch.period_y_mm, 0);
        for (std::uint32_t first : sheet.segments)
          if (distance_to_column(patch, sheet, first, offset, margin) < 0)
            EXPECT_TRUE(contains_segment(cell, sheet, first, offset)) << "margin " << margin;
        for (std::uint32_t first : cell.segments) {
          ASSERT_LT(first + 3, cell.control_points.size());
          // Control polygons reach a knot spacing beyond their curve and boxes have corners: 0.5 mm here.
          EXPECT_LT(distance_to_column(patch, cell, first, Vector3d::Zero(), margin), 0.5);
        }
      }
    }
  }
}

TEST(PatchCurvesTest, ACellHoldsNoSegmentTwice) {
  const YarnPatch patch = initial_patch(plain_draft());
  const CurveSet cell = cell_curves_of(patch, 0, 2.5);
  std::vector<std::array<float, 3>> middles;
  for (std::uint32_t first : cell.segments) {
    const Vector3d p = point_of(cell, first, 0.5);
    for (const auto& m : middles) EXPECT_GT((p - Vector3d(m[0], m[1], m[2])).norm(), 1e-3);
    middles.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  }
}

}  // namespace
}  // namespace renderer
