#include "renderer/weave/patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/patch_measures.h"
#include "tests/renderer/weave/relaxed_cloths.h"

namespace renderer {
namespace {

using Eigen::Vector3d;

Draft with_sett(Draft draft, double warp_pitch_mm, double weft_pitch_mm) {
  draft.warp.pitch_mm = warp_pitch_mm;
  draft.weft.pitch_mm = weft_pitch_mm;
  return draft;
}

// Setts that round yarns of 0.5 mm can be woven in, tight and open, even and uneven.
std::vector<Draft> free_drafts() {
  return {with_sett(plain_draft(), 0.9, 0.9),      with_sett(plain_draft(), 1.6, 1.2),
          with_sett(twill_draft(2, 2), 0.65, 1.0), with_sett(twill_draft(3, 1), 0.6, 1.05),
          with_sett(twill_draft(1, 3), 1.0, 1.0),  with_sett(satin_draft(5, 2), 0.55, 1.1),
          with_sett(satin_draft(8, 3), 0.55, 1.1), with_sett(basket_draft(2), 0.9, 0.9)};
}

// The heights of a warp and a weft yarn where they are closest in plan, found without knowing where that is.
std::pair<double, double> heights_at_crossing(const YarnPatch& patch, const Yarn& warp, const Yarn& weft) {
  const PeriodicSpline a = center_line(patch, warp), b = center_line(patch, weft);
  double least = std::numeric_limits<double>::infinity();
  std::pair<double, double> heights;
  for (std::size_t i = 0; i < a.control_points.size() * 4; ++i) {
    const Vector3d p = spline_value(a, static_cast<double>(i) / 4);
    for (std::size_t j = 0; j < b.control_points.size() * 4; ++j) {
      const Vector3d q = spline_value(b, static_cast<double>(j) / 4);
      const double dx = std::remainder(p.x() - q.x(), patch.period_x_mm),
                   dy = std::remainder(p.y() - q.y(), patch.period_y_mm);
      if (dx * dx + dy * dy >= least) continue;
      least = dx * dx + dy * dy;
      heights = {p.z(), q.z()};
    }
  }
  return heights;
}

// Least gap by comparing all pairs of samples in all neighbouring images.
double gap_by_all_pairs(const YarnPatch& patch) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < patch.yarns.size(); ++i) {
    for (std::size_t j = i + 1; j < patch.yarns.size(); ++j) {
      const PeriodicSpline a = center_line(patch, patch.yarns[i]), b = center_line(patch, patch.yarns[j]);
      for (std::size_t s = 0; s < a.control_points.size() * 8; ++s) {
        const Vector3d p = spline_value(a, static_cast<double>(s) / 8);
        for (std::size_t t = 0; t < b.control_points.size() * 8; ++t) {
          const Vector3d q = spline_value(b, static_cast<double>(t) / 8);
          const Vector3d d(std::remainder(p.x() - q.x(), patch.period_x_mm),
                           std::remainder(p.y() - q.y(), patch.period_y_mm), p.z() - q.z());
          least = std::min(least, d.norm() - patch.yarns[i].radius_mm - patch.yarns[j].radius_mm);
        }
      }
    }
  }
  return least;
}

TEST(PatchTest, EveryCrossingIsAsDraftedAndYarnsTouchThere) {
  for (const Draft& draft : free_drafts()) {
    const YarnPatch patch = initial_patch(draft);
    const std::size_t ends = draft.warp_over[0].size(), picks = draft.warp_over.size();
    ASSERT_EQ(patch.yarns.size(), ends + picks);
    for (std::size_t end = 0; end < ends; ++end) {
      for (std::size_t pick = 0; pick < picks; ++pick) {
        const auto [warp, weft] = heights_at_crossing(patch, patch.yarns[end], patch.yarns[ends + pick]);
        EXPECT_EQ(warp > weft, draft.warp_over[pick][end]) << draft.name << " end " << end << " pick " << pick;
        EXPECT_NEAR(std::abs(warp - weft), 0.5, 1e-9) << draft.name;  // two radii, to rounding
      }
    }
  }
}

TEST(PatchTest, YarnsThatAreFreeToBeWovenOverlapByNoMoreThanTheSplinesMiss) {
  for (const Draft& draft : free_drafts()) {
    const YarnPatch patch = initial_patch(draft);
    // Arcs, lines and floats meet with a jump of curvature that a C2 spline rounds off: measured 0.3 to 1.05 % of the
    // radius.
    EXPECT_GT(patch.least_gap_mm, -0.011 * 0.25) << draft.name;
    EXPECT_LE(patch.least_gap_mm, 1e-12) << draft.name << ": yarns touch at every crossing";
  }
}

TEST(PatchTest, TheLeastGapIsThatOfAllPairsOfPoints) {
  for (Draft draft : {with_sett(plain_draft(), 0.9, 0.9), with_sett(plain_draft(), 0.62, 0.62),
                      with_sett(satin_draft(5, 2), 0.55, 1.1)}) {
    const YarnPatch patch = initial_patch(draft);
    const double sampled = gap_by_all_pairs(patch);
    EXPECT_LE(patch.least_gap_mm, sampled + 1e-4) << draft.name;
    EXPECT_NEAR(patch.least_gap_mm, sampled, 1e-3) << draft.name;  // samples stand 0.02 mm apart: 0.01^2 / (2 * 0.5)
  }
  for (double scale :
       {0.5, 3.0}) {  // pressed into each other; torn apart, so that yarns come closest beside the crossings
    Draft scaled = with_sett(plain_draft(), 0.9, 0.9);
    scaled.height_scale = scale;
    const YarnPatch patch = initial_patch(scaled);
    EXPECT_EQ(patch.least_gap_mm > 0, scale > 1);
    EXPECT_NEAR(patch.least_gap_mm, gap_by_all_pairs(patch), 1e-3) << scale;
  }
}

// In an irregular cloth one pair of yarns is the closest, wherever it lies: across a border, among parallel yarns.
TEST(PatchTest, TheLeastGapOfAnIrregularClothIsThatOfAllPairsOfPoints) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const bool small = seed % 2 == 0;
    YarnPatch patch =
        initial_patch(small ? with_sett(plain_draft(), 1.1, 1.0) : with_sett(twill_draft(2, 1), 1.0, 1.1));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> side(-0.3, 0.3), height(-0.05, 0.05);
    for (Yarn& yarn : patch.yarns) {
      const Vector3d move = (yarn.warp ? Vector3d::UnitX() : Vector3d::UnitY()) * side(random);
      for (Vector3d& point : yarn.control_points) point += move + Vector3d(0, 0, height(random));
    }
    EXPECT_NEAR(least_gap(patch), gap_by_all_pairs(patch), 1e-3) << seed;
  }
}

// Straight yarns of radius 0.25 mm at the given x (warp) or y (weft) in a cell of `size`. Far above and below lie
// others, many of the same system, so that yarns are expected close to each other and the search looks no farther
// than it must.
YarnPatch straight_yarns(const std::vector<double>& places, bool warp, double size) {
  YarnPatch patch;
  patch.period_x_mm = patch.period_y_mm = size;
  const auto add = [&](bool is_warp, double place, double height) {
    Yarn yarn{.warp = is_warp, .control_points = {}};
    for (int k = 0; k < 32; ++k) {
      const double along = k * size / 32;
      yarn.control_points.push_back(is_warp ? Vector3d(place, along, height) : Vector3d(along, place, height));
    }
    patch.yarns.push_back(yarn);
  };
  for (double place : places) add(warp, place, 0);
  for (int i = 0; i < 8; ++i) add(warp, size * i / 8, 3 + i);
  add(!warp, size / 2, -3);
  return patch;
}

TEST(PatchTest, TheLeastGapIsSeenAcrossTheBordersOfTheCellInWhicheverOrderTheYarnsAreListed) {
  for (bool warp : {true, false}) {
    for (double size : {1.2, 2.0, 10.0}) {
      EXPECT_NEAR(least_gap(straight_yarns({0.3, size - 0.1}, warp, size)), -0.1, 1e-9) << size;
      EXPECT_NEAR(least_gap(straight_yarns({size - 0.1, 0.3}, warp, size)), -0.1, 1e-9) << size;
    }
    for (double x = 1; x < 9; x += 0.37) {
      EXPECT_NEAR(least_gap(straight_yarns({x, x + 0.6}, warp, 10)), 0.1, 1e-9) << x;
      EXPECT_NEAR(least_gap(straight_yarns({x + 0.6, x}, warp, 10)), 0.1, 1e-9) << x;
    }
  }
}

TEST(PatchTest, ASettInWhichRoundYarnsJamIsWovenAndItsOverlapIsMeasured) {
  const YarnPatch jammed = initial_patch(with_sett(plain_draft(), 0.62, 0.62));
  EXPECT_LT(jammed.least_gap_mm, -0.1 * 0.25);
  double previous = 0;
  for (double pitch : {0.86, 0.8, 0.7, 0.6}) {  // Peirce: square cloth jams at 0.866
    const double gap = initial_patch(with_sett(plain_draft(), pitch, pitch)).least_gap_mm;
    EXPECT_LT(gap, previous) << pitch;
    previous = gap;
  }
}

TEST(PatchTest, CrimpIsNotBelowPeircesShortestPathAndAtMostThatOfStiffYarns) {
  const double table[][2]{{0.9, 18.71}, {1.0, 14.35}, {1.25, 8.648}, {1.5, 5.848}, {2.0, 3.212}, {3.0, 1.405}};
  for (const auto& [pitch, percent] : table) {  // D = 1 mm, so the pitch is p / D
    const YarnPatch patch = initial_patch(with_sett(plain_draft(), pitch, pitch));
    EXPECT_GT(100 * patch.crimp_warp, percent * 0.998) << pitch;  // splines cut corners: measured 0.1 % of the crimp
    EXPECT_LT(100 * patch.crimp_warp, percent * (pitch <= 1 ? 1.002 : 1.2)) << pitch;  // taut; beams: 0.6 / 0.5
  }
}

TEST(PatchTest, SquareClothIsSymmetric) {
  const YarnPatch patch = initial_patch(with_sett(plain_draft(), 1.0, 1.0));
  EXPECT_NEAR(patch.crimp_warp, patch.crimp_weft, 1e-12);
  EXPECT_NEAR(patch.thickness_mm, 1.0, 1e-9);  // two diameters: the crowns of both systems lie in one plane
  const SurfaceRange range = surface_range(patch);
  EXPECT_NEAR(range.low_mm, -range.high_mm, 1e-12);
  EXPECT_NEAR(patch.cover, 0.75, 1e-12);  // half of the width and half of the rest
}

TEST(PatchTest, MovingTheDraftByOneYarnMovesTheClothByOnePitch) {
  for (const Draft& draft : free_drafts()) {
    Draft moved = draft;
    for (std::vector<bool>& pick : moved.warp_over) std::rotate(pick.begin(), pick.begin() + 1, pick.end());
    const YarnPatch a = initial_patch(draft), b = initial_patch(moved);
    const std::size_t ends = draft.warp_over[0].size();
    for (std::size_t end = 0; end + 1 < ends; ++end) {
      for (std::size_t k = 0; k < a.yarns[end].control_points.size(); ++k) {
        const Vector3d expected = a.yarns[end + 1].control_points[k] - Vector3d(draft.warp.pitch_mm, 0, 0);
        EXPECT_LT((b.yarns[end].control_points[k] - expected).norm(), 1e-12);
      }
    }
    EXPECT_NEAR(a.crimp_weft, b.crimp_weft, 1e-12);
    EXPECT_NEAR(a.thickness_mm, b.thickness_mm, 1e-12);
    EXPECT_NEAR(a.least_gap_mm, b.least_gap_mm, 1e-9);
  }
}

TEST(PatchTest, TurningTheDraftExchangesWarpAndWeft) {
  for (const Draft& draft : free_drafts()) {
    const YarnPatch a = initial_patch(draft), b = initial_patch(turned(draft));
    const std::size_t picks = draft.warp_over.size(), ends = draft.warp_over[0].size();
    EXPECT_NEAR(a.crimp_warp, b.crimp_weft, 1e-12) << draft.name;
    EXPECT_NEAR(a.crimp_weft, b.crimp_warp, 1e-12) << draft.name;
    EXPECT_NEAR(a.thickness_mm, b.thickness_mm, 1e-12) << draft.name;
    EXPECT_NEAR(a.cover, b.cover, 1e-12) << draft.name;
    EXPECT_NEAR(a.least_gap_mm, b.least_gap_mm, 1e-9) << draft.name;
    for (std::size_t end = 0; end < ends;
         ++end) {  // warp end j, turned, is weft pick j; (x, y) becomes (height - y, x)
      const PeriodicSpline warp = center_line(a, a.yarns[end]), weft = center_line(b, b.yarns[picks + end]);
      const auto count = static_cast<double>(warp.control_points.size());
      for (double t : {0.0, 3.3, 6.0, 11.2}) {
        const Vector3d p = spline_value(warp, t);
        EXPECT_LT((Vector3d(a.period_y_mm - p.y(), p.x(), p.z()) - spline_value(weft, count - t)).norm(), 1e-9);
      }
    }
  }
}

TEST(PatchTest, WritingTheRepeatTwiceBothWaysGivesTheSameCloth) {
  for (const Draft& draft : free_drafts()) {
    Draft doubled = draft;
    for (std::vector<bool>& pick : doubled.warp_over)
      pick.insert(pick.end(), pick.begin(), pick.begin() + static_cast<std::ptrdiff_t>(pick.size()));
    const auto once = doubled.warp_over;
    doubled.warp_over.insert(doubled.warp_over.end(), once.begin(), once.end());
    const YarnPatch a = initial_patch(draft), b = initial_patch(doubled);
    EXPECT_NEAR(b.period_x_mm, 2 * a.period_x_mm, 1e-12);
    EXPECT_NEAR(b.period_y_mm, 2 * a.period_y_mm, 1e-12);
    EXPECT_NEAR(a.crimp_warp, b.crimp_warp, 1e-12) << draft.name;
    EXPECT_NEAR(a.crimp_weft, b.crimp_weft, 1e-12) << draft.name;
    EXPECT_NEAR(a.thickness_mm, b.thickness_mm, 1e-12) << draft.name;
    EXPECT_NEAR(a.cover, b.cover, 1e-12) << draft.name;
    EXPECT_NEAR(a.least_gap_mm, b.least_gap_mm, 1e-9) << draft.name;
    const PeriodicSpline single = center_line(a, a.yarns[1]), twice = center_line(b, b.yarns[1]);
    for (double t : {0.0, 5.5, 17.25, 30.1})
      EXPECT_LT((spline_value(single, t) - spline_value(twice, t)).norm(), 1e-12);
  }
}

TEST(PatchTest, YarnsHaveTheThreadsAndSizesOfTheDraft) {
  Draft draft = with_sett(plain_draft(), 0.9, 1.1);
  draft.warp = {.diameter_mm = 0.4, .pitch_mm = 0.9, .threads = {0, 1, 2}};
  draft.weft.threads = {3, 3, 4, 4};
  const YarnPatch patch = initial_patch(draft);
  ASSERT_EQ(patch.yarns.size(), 6u + 4u);
  for (std::size_t k = 0; k < 10; ++k) {
    const bool warp = k < 6;
    EXPECT_EQ(patch.yarns[k].warp, warp);
    EXPECT_EQ(patch.yarns[k].radius_mm, warp ? 0.2 : 0.25);
    EXPECT_EQ(patch.yarns[k].thread, warp ? static_cast<int>(k % 3) : (k < 8 ? 3 : 4));
  }
  EXPECT_NEAR(patch.period_x_mm, 5.4, 1e-12);
  EXPECT_NEAR(patch.period_y_mm, 4.4, 1e-12);
}

TEST(PatchTest, HeightScaleStretchesTheHeightsAndNothingElse) {
  const Draft draft = with_sett(satin_draft(5, 2), 0.55, 1.1);
  Draft low = draft;
  low.height_scale = 0.7;
  const YarnPatch a = initial_patch(draft), b = initial_patch(low);
  for (std::size_t i = 0; i < a.yarns.size(); ++i) {
    for (std::size_t k = 0; k < a.yarns[i].control_points.size(); ++k) {
      const Vector3d expected = a.yarns[i].control_points[k].cwiseProduct(Vector3d(1, 1, 0.7));
      EXPECT_LT((b.yarns[i].control_points[k] - expected).norm(), 1e-12);
    }
  }
  EXPECT_EQ(b.height_scale, 0.7);
  EXPECT_NEAR(b.thickness_mm - 0.5, 0.7 * (a.thickness_mm - 0.5), 1e-12);
  EXPECT_LT(b.crimp_warp, a.crimp_warp);
  EXPECT_LT(b.least_gap_mm, -0.1);  // crossings at 0.35 mm instead of 0.5 mm
}

}  // namespace
}  // namespace renderer
