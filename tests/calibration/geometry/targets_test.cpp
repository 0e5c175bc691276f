#include "calibration/geometry/targets.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace calibration {
namespace {

TEST(Targets, RingTagsLieFlatAndStandUprightForWhoLooksFromOutside) {
  const TagLayout ring = make_platform_ring(12, 60.0, 14.0, 300);
  ASSERT_EQ(ring.tags.size(), 12U);
  EXPECT_EQ(ring.tags[11].id, 311);
  EXPECT_TRUE(ring.tags[0].object_from_tag.translation().isApprox(Eigen::Vector3d(60, 0, 0)));
  EXPECT_TRUE(ring.tags[3].object_from_tag.translation().isApprox(Eigen::Vector3d(0, 60, 0)));  // counter-clockwise
  for (const Tag& tag : ring.tags) {
    const Eigen::Matrix3d axes = tag.object_from_tag.linear();
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-12);
    EXPECT_TRUE(axes.col(2).isApprox(Eigen::Vector3d::UnitZ()));
    EXPECT_LT(axes.col(1).dot(tag.object_from_tag.translation()), -59.9);  // its top points inwards
  }
}

TEST(Targets, RingTagsThatDoNotFitSideBySideAreRefused) {
  EXPECT_NO_THROW(make_platform_ring(12, 60.0, 20.0, 300));
  EXPECT_THROW(make_platform_ring(12, 60.0, 23.0, 300), std::runtime_error);
  EXPECT_THROW(make_platform_ring(12, 8.0, 14.0, 300), std::runtime_error);
  EXPECT_THROW(make_platform_ring(2, 60.0, 14.0, 300), std::runtime_error);
}

TEST(Targets, TableTagsAreUprightForTheCameraAndMayNotOverlap) {
  const TagLayout table = make_table_sheet({{-128, -67}, {-128, 67}}, 24.0, 400);
  ASSERT_EQ(table.tags.size(), 2U);
  EXPECT_EQ(table.tags[1].id, 401);
  for (const Tag& tag : table.tags) {
    EXPECT_TRUE(tag.object_from_tag.linear().col(2).isApprox(Eigen::Vector3d::UnitZ()));
    EXPECT_TRUE(tag.object_from_tag.linear().col(1).isApprox(-Eigen::Vector3d::UnitX()));
  }
  EXPECT_THROW(make_table_sheet({{0, 0}, {29, 10}}, 24.0, 400), std::runtime_error);  // 30 mm with the border
}

TEST(Targets, APrintTwoPercentTooLargeHasAllLengthsTwoPercentLarger) {
  const TagLayout drawn = make_corner_tags("face", 14.0, 34.5, 200, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  const TagLayout print = scaled(drawn, 102.0);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto a = corners_in_object(drawn.tags[i]), b = corners_in_object(print.tags[i]);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_TRUE(b[c].isApprox(1.02 * a[c]));
  }
}

TEST(Targets, AnIdOnTwoTargetsIsNamedWithBoth) {
  const TagLayout board = make_tag_board("board", 3, 4, 20.0, 30.0, 0);
  const TagLayout ring = make_platform_ring(12, 60.0, 14.0, 300);
  EXPECT_EQ(shared_ids({board, ring}), "");
  const std::string shared = shared_ids({board, make_platform_ring(12, 60.0, 14.0, 11)});
  EXPECT_NE(shared.find("tag 11"), std::string::npos) << shared;
  EXPECT_NE(shared.find("board"), std::string::npos) << shared;
}

}  // namespace
}  // namespace calibration
