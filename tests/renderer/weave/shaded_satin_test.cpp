#include "renderer/weave/shaded_satin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "renderer/weave/initial_patch.h"
#include "renderer/weave/patch_measures.h"
#include "renderer/weave/woven_patch.h"

namespace renderer {
namespace {

Draft of_shades(const cv::Mat1b& shades) {
  Draft draft = plain_draft();
  draft.warp_over = shaded_structure(shades);
  draft.relaxed = false;
  return draft;
}

TEST(ShadedSatins, EachHasItsShareOfTheWarpOnTopAndIsSatin) {
  for (int shade = 1; shade <= kShades; ++shade) {
    const auto rows = shaded_structure(cv::Mat1b(kSatinEnds, kSatinEnds, static_cast<uchar>(shade)));
    for (std::size_t pick = 0; pick < rows.size(); ++pick) {
      EXPECT_EQ(std::count(rows[pick].begin(), rows[pick].end(), true), shade);
      if (shade > 1) continue;
      EXPECT_EQ(std::find(rows[pick].begin(), rows[pick].end(), true) - rows[pick].begin(),
                static_cast<std::ptrdiff_t>(pick * 3 % 8));
    }
    EXPECT_FALSE(check_draft(of_shades(cv::Mat1b(kSatinEnds, kSatinEnds, static_cast<uchar>(shade)))));
  }
}

TEST(ShadedSatins, AnyMixtureIsACloth) {
  std::mt19937 random(3);
  cv::Mat1b shades(40, 56);
  for (uchar& shade : shades) shade = static_cast<uchar>(1 + random() % kShades);
  const Draft draft = of_shades(shades);
  EXPECT_FALSE(check_draft(draft)) << *check_draft(draft);
  EXPECT_THROW(shaded_structure(cv::Mat1b(8, 8, uchar{0})), std::invalid_argument);
  EXPECT_THROW(shaded_structure(cv::Mat1b(8, 8, uchar{8})), std::invalid_argument);
}

TEST(ShadedSatins, ThePicturesFirstRowIsTheLastPick) {
  cv::Mat1b shades(16, 8, uchar{1});
  shades.rowRange(0, 8).setTo(kShades);
  const auto rows = shaded_structure(shades);
  EXPECT_EQ(std::count(rows.front().begin(), rows.front().end(), true), 1);
  EXPECT_EQ(std::count(rows.back().begin(), rows.back().end(), true), kShades);
}

TEST(UnrelaxedDrafts, KeepTheAnalyticShapesAndMayBeLarger) {
  Draft draft = of_shades(cv::Mat1b(72, 72, uchar{4}));
  EXPECT_FALSE(check_draft(draft)) << *check_draft(draft);
  const YarnPatch drawn = woven_patch(draft).patch, initial = initial_patch(draft);
  ASSERT_EQ(drawn.yarns.size(), initial.yarns.size());
  EXPECT_EQ(drawn.yarns[5].control_points, initial.yarns[5].control_points);
  draft.relaxed = true;
  EXPECT_TRUE(check_draft(draft)) << "72 x 72 crossings are more than 4096";
  draft.relaxed = false;
  draft.transverse_modulus_n_mm2 = 3;
  EXPECT_TRUE(check_draft(draft));
}

}  // namespace
}  // namespace renderer
