#include "inversion/view/noise_law.h"

#include <gtest/gtest.h>

namespace inversion {
namespace {

// Radiance rising along a row, each channel with a law of its own; the last column is outside the mask and far off.
struct Pictures {
  cv::Mat3f radiance{cv::Size(11, 2)}, variance{cv::Size(11, 2)};
  cv::Mat1b mask{cv::Size(11, 2), uchar{255}};
  Pictures() {
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 11; ++column) {
        const float light = 0.1F * static_cast<float>(column);
        radiance(row, column) = {light, 2 * light, 3 * light};
        variance(row, column) = {1 + 2 * light, 0.5F, 4 * 3 * light};
      }
    mask.col(10).setTo(0);
    variance.col(10).setTo(cv::Scalar::all(1000));
  }
};

TEST(NoiseLawTest, ALawIsFoundAgainAndOnlyTheMaskCounts) {
  const Pictures pictures;
  const auto law = noise_law(pictures.radiance, pictures.variance, pictures.mask);
  ASSERT_TRUE(law);
  EXPECT_TRUE(law->floor.isApprox(Eigen::Array3d(1, 0.5, 0), 1e-5)) << law->floor;
  EXPECT_TRUE(law->slope.isApprox(Eigen::Array3d(2, 0, 4), 1e-5)) << law->slope;
}

TEST(NoiseLawTest, LightHasItsVarianceAndDarknessTheFloor) {
  const NoiseLaw law{.floor = {1, 2, 3}, .slope = {10, 20, 30}};
  EXPECT_TRUE(variance_by(law, {0.5, -0.5, 0}).isApprox(Eigen::Array3d(6, 2, 3)));
}

TEST(NoiseLawTest, ADividedPictureHasTheVarianceDividedTwice) {
  const NoiseLaw law{.floor = {1, 2, 3}, .slope = {10, 20, 30}};
  const Eigen::Array3d radiance(0.5, 2, 7);
  EXPECT_TRUE(variance_by(divided(law, 4), radiance / 4).isApprox(variance_by(law, radiance) / 16));
}

TEST(NoiseLawTest, WithoutVariancesOrThreadsThereIsNone) {
  const Pictures pictures;
  EXPECT_FALSE(noise_law(pictures.radiance, {}, pictures.mask));
  EXPECT_FALSE(noise_law(pictures.radiance, pictures.variance, cv::Mat1b(2, 11, uchar{0})));
}

TEST(NoiseLawTest, AnEvenPictureHasAFloorOnly) {
  const cv::Mat3f even(3, 3, cv::Vec3f::all(2)), noise(3, 3, cv::Vec3f::all(0.25F));
  const auto law = noise_law(even, noise, cv::Mat1b(3, 3, uchar{255}));
  ASSERT_TRUE(law);
  EXPECT_TRUE(law->slope.isZero());
  EXPECT_TRUE(law->floor.isApproxToConstant(0.25));
}

}  // namespace
}  // namespace inversion
