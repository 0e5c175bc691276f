// Cloths of two threads for the tests of exports, and measures of them.
#pragma once

#include "station/cloth/export/cloth_sample.h"

namespace station_test {

// A plain weave of round yarns with holes: 2 ends and 2 picks, 1.8 x 1.8 mm; its cover is 1 - (1 - 0.5 / 0.9)^2 by
// arithmetic.
station::ClothSample plain_cloth(const renderer::ThreadParameters& warp, const renderer::ThreadParameters& weft);
// A satin of 5, whose period is longer than it is wide.
station::ClothSample satin_cloth(const renderer::ThreadParameters& warp, const renderer::ThreadParameters& weft);

renderer::ThreadParameters black_thread();
renderer::ThreadParameters red_thread();

// The mean radiance straight from above for light on one side, by other samples than those of a bake.
Eigen::Array3d furnace(const station::ClothSample& cloth, bool light_above);

Eigen::Array3d mean_of(const cv::Mat3f& picture);

}  // namespace station_test
