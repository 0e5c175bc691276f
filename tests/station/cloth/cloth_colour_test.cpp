// Cloth in a wanted colour: what is found for it looks like it, and what no absorption can give is said.
#include "station/cloth/cloth_colour.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "renderer/picture/image_file.h"
#include "renderer/weave/woven_patch.h"
#include "station/documents/draft_file.h"
#include "tests/places.h"

namespace station {
namespace {

using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

struct ClothColour : testing::Test {
  ThreadFile thread = read_thread(std::string(DATA_DIR) + "/threads/silk_red.json");
  renderer::YarnPatch patch = renderer::woven_patch(read_draft(std::string(DATA_DIR) + "/drafts/twill_2_2.json")).patch;
};

TEST_F(ClothColour, ItIsReachedByAbsorptionAlone) {
  const Srgb8 wanted{0xb0, 0xc0, 0xa0};
  double last = 0;
  const ClothColours colours(thread, patch, [&](double done) { last = done; });
  EXPECT_GT(last, 0.8);
  const ColouredThread found = colours.thread_of(wanted);
  EXPECT_LT(found.delta_e_2000, 0.1);
  EXPECT_EQ(found.parameters.alpha, thread.parameters.alpha);
  EXPECT_EQ(found.parameters.r0a, thread.parameters.r0a);
  const Eigen::Array3d camera = even_light_reflectance(patch, found.parameters, 99);
  const Matrix to_srgb = Eigen::Map<const Matrix>(thread.linear_srgb_from_camera.data());
  const Eigen::Vector3d seen = to_srgb * camera.matrix();
  const cv::Vec3f linear = renderer::linear_of_srgb({wanted[0], wanted[1], wanted[2]});
  // Each reflectance on the curve and this one scatter by about 0.01.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], linear[c], 0.03) << c;
}

TEST_F(ClothColour, WhatNoAbsorptionCanGiveIsSaid) {
  const ClothColours colours(thread, patch, [](double) {});
  EXPECT_GT(colours.thread_of({255, 255, 255}).delta_e_2000, 1);
}

TEST_F(ClothColour, DarkerThreadsMakeDarkerCloth) {
  renderer::ThreadParameters dark = thread.parameters, bright = thread.parameters;
  for (int c = 0; c < 3; ++c) dark.sigma_a[c] = 3, bright.sigma_a[c] = 0.05;
  EXPECT_LT(even_light_reflectance(patch, dark).maxCoeff(), even_light_reflectance(patch, bright).minCoeff());
}

}  // namespace
}  // namespace station
