#include "inversion/fit/block_estimate.h"

#include <gtest/gtest.h>

#include "tests/inversion/fit/synthetic_spool.h"

namespace inversion {
namespace {

using Slopes = renderer::ThreadSlopes<double>;

renderer::LobeAngles<double> in_double(const PathDirection& at) {
  renderer::LobeAngles<double> angles;
  angles.distance2.setConstant(static_cast<double>(at.distance2));
  angles.cos_cos.setConstant(static_cast<double>(at.cos_cos));
  angles.from_center << static_cast<double>(at.from_center[0]), static_cast<double>(at.from_center[1]),
      static_cast<double>(at.from_center[2]), 0.0;
  return angles;
}

// The formula of light_paths.h followed from vertex to vertex in double precision, slopes by the product rule.
BlockEstimate followed(const LightPaths& paths, std::size_t block, const renderer::ThreadParameters& thread) {
  const renderer::ThreadGradientModel<double> model(thread);
  BlockEstimate sum;
  for (std::size_t path = paths.block_paths[block]; path < paths.block_paths[block + 1]; ++path) {
    Eigen::Array3d throughput = Eigen::Array3d::Ones();
    Slopes throughput_slopes = Slopes::Zero();
    for (std::size_t e = path == 0 ? 0 : paths.path_ends[path - 1]; e < paths.path_ends[path]; ++e) {
      const PathEvent& event = paths.events[e];
      const renderer::ThreadPoint<double> point{static_cast<double>(event.point.cosine),
                                                static_cast<double>(event.point.chord_length)};
      const auto light = model.evaluate(point, in_double(event.light)),
                 next = model.evaluate(point, in_double(event.next));
      const auto w = static_cast<double>(event.light_weight), inverse_pdf = static_cast<double>(event.inverse_next_pdf);
      for (int c = 0; c < 3; ++c) {
        sum.value[c] += throughput[c] * light.f_cos[c] * w;
        sum.slopes.col(c) += throughput_slopes.col(c) * light.f_cos[c] * w + throughput[c] * light.slopes.col(c) * w;
        throughput_slopes.col(c) =
            (throughput_slopes.col(c) * next.f_cos[c] + throughput[c] * next.slopes.col(c)) * inverse_pdf;
        throughput[c] *= next.f_cos[c] * inverse_pdf;
      }
    }
  }
  const double count = paths.block_paths[block + 1] - paths.block_paths[block];
  sum.value /= count, sum.slopes /= count;
  return sum;
}

class BlockEstimateTest : public testing::TestWithParam<double> {};

TEST_P(BlockEstimateTest, IsThatOfPathsFollowedOneByOneInDoublePrecision) {
  const WrappedSpool spool;
  const View view = unlit_view(spool, {"view", 20, 0, GetParam(), 20}, 48);
  const std::vector<Block> blocks = mask_blocks(view.mask, 12);
  renderer::ThreadParameters shaded_with = known_thread();
  shaded_with.beta = {0.3, 0.5, 0.06};  // one narrow lobe: large derivatives
  for (int count : {1, 3, 1500}) {      // less than a packet of directions; more than are shaded together
    const LightPaths paths = trace_light_paths(spool_rays(spool), view, blocks, known_thread(), count, 5);
    for (std::size_t b = 0; b < blocks.size(); b += 3) {
      const BlockEstimate expected = followed(paths, b, shaded_with),
                          found = shade_block(paths, b, block_model(shaded_with), true),
                          plain = shade_block(paths, b, block_model(shaded_with), false);
      // Angles in float against the narrowest width (0.02 rad), along a few vertices.
      constexpr double kFloats = 1e-4;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(found.value[c], expected.value[c], kFloats * expected.value[c]) << count << ' ' << b;
        EXPECT_NEAR(plain.value[c], expected.value[c], kFloats * expected.value[c]) << count << ' ' << b;
        for (int k = 0; k < renderer::kThreadSlopeLanes; ++k)
          EXPECT_NEAR(found.slopes(k, c), expected.slopes(k, c),
                      kFloats * (std::abs(expected.slopes(k, c)) + 10 * expected.value[c]))
              << count << ' ' << b << ' ' << k;
      }
      EXPECT_TRUE((plain.slopes == 0).all());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lamps, BlockEstimateTest, testing::Values(-10, 165),
                         [](const auto& test) { return test.param < 0 ? "reflection" : "transmission"; });

TEST(BlockEstimateTest, ABlockWhosePathsMeetNothingIsBlack) {
  LightPaths paths;
  paths.path_ends = {0, 0, 0};
  paths.block_paths = {0, 3};
  const BlockEstimate found = shade_block(paths, 0, block_model(known_thread()), true);
  EXPECT_TRUE((found.value == 0).all() && (found.slopes == 0).all());
}

}  // namespace
}  // namespace inversion
