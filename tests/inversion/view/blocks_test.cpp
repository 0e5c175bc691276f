#include "inversion/view/blocks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

cv::Mat1b speckled_mask(int rows, int columns) {
  cv::Mat1b mask(rows, columns, std::uint8_t{0});
  std::mt19937 random(3);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      if (random() % 3 == 0 && x > columns / 4) mask(y, x) = 255;
  return mask;
}

TEST(BlocksTest, EveryMaskedPixelLiesInOneBlockAndNoOtherPixelDoes) {
  for (int side : {1, 4, 7, 100}) {  // dividing the picture or not, and one block for all
    const cv::Mat1b mask = speckled_mask(30, 44);
    cv::Mat1i seen(mask.size(), 0);
    for (const Block& block : mask_blocks(mask, side))
      for (const cv::Point& pixel : block.pixels) ++seen(pixel);
    for (int y = 0; y < mask.rows; ++y)
      for (int x = 0; x < mask.cols; ++x) ASSERT_EQ(seen(y, x), mask(y, x) ? 1 : 0) << x << ' ' << y << ' ' << side;
  }
}

TEST(BlocksTest, PixelsLieInTheirBlocksSquareAndNoBlockIsEmpty) {
  for (const Block& block : mask_blocks(speckled_mask(30, 44), 7)) {
    ASSERT_FALSE(block.pixels.empty());
    for (const cv::Point& pixel : block.pixels) EXPECT_EQ(pixel / 7, block.pixels.front() / 7);
  }
}

TEST(BlocksTest, AnEmptyMaskHasNoBlocks) {
  EXPECT_TRUE(mask_blocks(cv::Mat1b(9, 9, std::uint8_t{0}), 4).empty());
}

TEST(BlocksTest, TheMeanIsOverMaskedPixelsOnly) {
  cv::Mat1b mask(4, 4, std::uint8_t{0});
  mask(0, 1) = mask(3, 2) = 255;
  cv::Mat3f picture(4, 4, cv::Vec3f(1000, 1000, 1000));
  picture(0, 1) = {1, 2, 3};
  picture(3, 2) = {3, 6, 9};
  const std::vector<Block> blocks = mask_blocks(mask, 4);
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_TRUE((block_mean(blocks[0], picture) == Eigen::Array3d(2, 4, 6)).all());
}

TEST(BlocksTest, APooledPixelCoversTwoPitchesInTheNearestViewAndNoMore) {
  const WrappedSpool spool;
  std::vector<View> views(2);
  for (std::size_t i = 0; i < 2; ++i) {
    views[i].camera = renderer::look_at({i == 0 ? 450.0 : 700.0, 0, 0}, {0, 0, 0}, {0, 0, 1});
    views[i].camera.fx = views[i].camera.fy = 2345;
  }
  const renderer::Camera& nearest = views[0].camera;
  const double two_pitches_px = (renderer::project(nearest, {0, 0, spool.thread_diameter_mm}) -
                                 renderer::project(nearest, {0, 0, -spool.thread_diameter_mm}))
                                    .norm();
  const int side = pooled_px(spool, views);
  EXPECT_GE(side, two_pitches_px);
  EXPECT_LT(side, two_pitches_px + 1);
}

TEST(BlocksTest, APooledPixelIsAtLeastAPixel) {
  View far;
  far.camera = renderer::look_at({1e5, 0, 0}, {0, 0, 0}, {0, 0, 1});
  EXPECT_EQ(pooled_px(WrappedSpool{}, {far}), 1);
}

}  // namespace
}  // namespace inversion
