// A cloth that is a glTF surface itself is found again; one that is not is judged by how far it is off.
#include "station/cloth/export/pbr_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace station {
namespace {

using Eigen::Array3d;

// Even reflectances and leaning normals of no cloth in particular.
BakedSide drawn_side() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  const cv::Size size(24, 24);
  BakedSide side{.reflectance = cv::Mat3f(size),
                 .transmittance = cv::Mat3f(size),
                 .opacity = cv::Mat1f(size),
                 .normal = cv::Mat3f(size)};
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      const float red = 0.3f + 0.2f * uniform(random);
      side.opacity(row, column) = column % 6 == 0 ? 0.5f : 1.0f;
      side.reflectance(row, column) = side.opacity(row, column) * cv::Vec3f(red, 0.6f * red, 0.25f);
      side.transmittance(row, column) = side.opacity(row, column) * cv::Vec3f(0.1f, 0.05f, 0.05f);
      const cv::Vec3f normal(1.2f * uniform(random) - 0.6f, 1.2f * uniform(random) - 0.6f, 1);
      side.normal(row, column) = normal / static_cast<float>(cv::norm(normal));
    }
  return side;
}

TEST(PbrFit, FindsTheMaterialOfASurfaceThatIsOne) {
  const BakedSide side = drawn_side();
  const GltfMaterial truth{.roughness = 0.45,
                           .specular = 0.8,
                           .specular_level = 1.5,
                           .specular_tint = 0.2,
                           .sheen = 0.15,
                           .sheen_tint = 0.7,
                           .sheen_roughness = 0.5,
                           .normal_scale = 0.4};
  const GltfShader shader(truth);
  const std::vector<PbrTexel> texels = texels_of(side, shader, 12);
  const std::vector<DirectionPair> pairs = standard_pairs();
  std::vector<Array3d> measured;
  for (const DirectionPair& pair : pairs)
    measured.push_back(mean_radiance(texels, shader, pair.to_view, pair.to_light));
  const PbrFit fit = fit_material(side, pairs, measured);
  EXPECT_NEAR(fit.material.roughness, truth.roughness, 0.02);
  EXPECT_NEAR(fit.material.normal_scale, truth.normal_scale, 0.03);
  EXPECT_NEAR(fit.material.sheen, truth.sheen, 0.03);
  const GltfShader found(fit.material);
  const auto errors = far_field_errors(texels_of(side, found, 12), found, pairs, measured);
  EXPECT_LT(agreement(errors, true).relative_rms, 0.01);
  EXPECT_LT(agreement(errors, true).mean_delta_e, 0.2);
  EXPECT_LT(agreement(errors, false).relative_rms, 0.02) << "light from behind follows, it is not fitted";
}

TEST(PbrFit, AgreementIsThatOfTheErrorsOnEachSide) {
  const Array3d grey = Array3d::Constant(0.2), bright = Array3d::Constant(0.3);
  const DirectionPair front{direction_at(0, 0), direction_at(30, 0)}, behind{direction_at(0, 0), direction_at(150, 0)};
  const std::vector<FarFieldError> errors{{front, grey, grey, 0}, {front, grey, bright, 8}, {behind, grey, grey, 0}};
  EXPECT_EQ(agreement(errors, true).pairs, 2);
  EXPECT_NEAR(agreement(errors, true).relative_rms, std::sqrt(0.01 / 0.08), 1e-12);
  EXPECT_NEAR(agreement(errors, true).mean_delta_e, 4, 1e-12);
  EXPECT_EQ(agreement(errors, false).relative_rms, 0);
}

TEST(PbrFit, ShadesATexelAsItsBakeWasSeen) {
  const BakedSide side = drawn_side();
  const GltfShader shader(GltfMaterial{.roughness = 0.4, .sheen = 0.2, .normal_scale = 0.5});
  const EvenLight even(shader);
  const std::vector<PbrTexel> texels = texels_of(side, shader, 24);
  for (const std::size_t i : {std::size_t{0}, std::size_t{100}, std::size_t{333}}) {
    const EvenLight::Seen seen = even.seen(texels[i]);
    const cv::Vec3f &reflectance = side.reflectance(static_cast<int>(i) / 24, static_cast<int>(i) % 24),
                    &transmittance = side.transmittance(static_cast<int>(i) / 24, static_cast<int>(i) % 24);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(texels[i].opacity * seen.reflectance[c], reflectance[c], 1e-6);
      EXPECT_NEAR(texels[i].opacity * seen.transmittance[c], transmittance[c], 1e-6);
    }
  }
}

}  // namespace
}  // namespace station
