// Table tags that have moved, beside tags that a shadow only seems to move.
#include "calibration/geometry/still_tags.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <functional>
#include <random>

namespace calibration {
namespace {

using Eigen::Vector2d;

constexpr unsigned kTagSeed = 20261130;

// Six tags on a table that is seen obliquely: places on the table (mm) and in the picture (px).
Vector2d in_picture(const Vector2d& table_mm) {
  const double depth = 1 + 0.001 * table_mm.y();
  return {600 + 1.1 * table_mm.x() / depth, 400 + 0.45 * table_mm.y() / depth};
}

using Move = std::function<Vector2d(const Vector2d& corner_mm, const Vector2d& middle_mm)>;

// The picture of the tags, in which tag 2 has been moved on the table.
TagObservation picture_of(std::mt19937& random, const Move& move) {
  std::normal_distribution<double> noise(0, 0.08);  // px
  TagObservation seen;
  for (int id = 0; id < 6; ++id) {
    const Vector2d middle_mm(id % 2 ? 250.0 : -250.0, 110.0 * (id / 2));
    TagDetection tag;
    tag.id = id;
    for (std::size_t c = 0; c < 4; ++c) {
      Vector2d corner = middle_mm + 22 * Vector2d(c == 1 || c == 2 ? 1 : -1, c >= 2 ? 1 : -1);
      if (id == 2) corner = move(corner, middle_mm);
      tag.corners_px[c] = in_picture(corner) + Vector2d(noise(random), noise(random));
    }
    seen.push_back(tag);
  }
  return seen;
}

class StillTagsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::printf("seed %u\n", kTagSeed);
    TagLayout layout;
    for (int id = 0; id < 6; ++id) {
      layout.tags.emplace_back();
      layout.tags.back().id = id;
    }
    std::vector<TagObservation> pictures;
    for (int i = 0; i < 20; ++i) pictures.push_back(picture_of(random_, stay));
    reference_ = still_tags(layout, pictures);
  }
  static Vector2d stay(const Vector2d& corner_mm, const Vector2d&) { return corner_mm; }
  Shift shift(const Move& move) {
    const auto found = shift_of(reference_, picture_of(random_, move));
    EXPECT_TRUE(found);
    return found.value_or(Shift{});
  }
  std::mt19937 random_{kTagSeed};
  StillTags reference_;
};

TEST_F(StillTagsTest, ATagThatWasMovedOrTurnedIsNamed) {
  for (int i = 0; i < 50; ++i) {
    const double way = 2 * static_cast<double>(EIGEN_PI) * std::uniform_real_distribution<>(0, 1)(random_);
    const Vector2d by_mm = 1.5 * Vector2d(std::cos(way), std::sin(way));
    const Shift moved = shift([&](const Vector2d& corner, const Vector2d&) -> Vector2d { return corner + by_mm; });
    EXPECT_EQ(moved.odd_id, 2);
    EXPECT_TRUE(shift_problem(moved, 0.38, "view")) << moved.odd_px;
    // About a pin in its corner.
    const double angle = (i % 2 ? 1 : -1) * 0.08;
    const Shift turned = shift([&](const Vector2d& corner, const Vector2d& middle) -> Vector2d {
      const Vector2d pin = middle + Vector2d(22, 22);
      return pin + Eigen::Rotation2Dd(angle) * (corner - pin);
    });
    EXPECT_EQ(turned.odd_id, 2);
    EXPECT_TRUE(shift_problem(turned, 0.38, "view")) << turned.odd_px;
  }
}

TEST_F(StillTagsTest, ATagThatAShadowCutsIsNotTakenForOneThatWasMoved) {
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(shift_problem(shift(stay), 0.38, "view"));
    const double depth_mm = std::uniform_real_distribution<>(2, 10)(random_);
    // Over one side, and over one corner.
    const Shift side = shift([&](const Vector2d& corner, const Vector2d& middle) -> Vector2d {
      return corner.x() > middle.x() ? Vector2d(corner - Vector2d(depth_mm, 0)) : corner;
    });
    EXPECT_FALSE(shift_problem(side, 0.38, "view")) << depth_mm << ' ' << side.odd_px;
    const Shift one = shift([&](const Vector2d& corner, const Vector2d& middle) -> Vector2d {
      return corner.x() > middle.x() && corner.y() > middle.y() ? Vector2d(corner - Vector2d(depth_mm, depth_mm))
                                                                : corner;
    });
    EXPECT_FALSE(shift_problem(one, 0.38, "view")) << depth_mm << ' ' << one.odd_px;
  }
}

}  // namespace
}  // namespace calibration
