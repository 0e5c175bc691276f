// Cloths of two threads for the tests of exports.
#pragma once

#include "station/export/cloth_sample.h"

namespace station_test {

// Plain weave of round yarns with holes: 2 ends and 2 picks, 1.8 x 1.8 mm; cover by arithmetic 1 - (1 - 0.5 / 0.9)^2.
station::ClothSample plain_cloth(const renderer::ThreadParameters& warp, const renderer::ThreadParameters& weft);
// Satin of 5, whose period is longer than it is wide.
station::ClothSample satin_cloth(const renderer::ThreadParameters& warp, const renderer::ThreadParameters& weft);

renderer::ThreadParameters black_thread();
renderer::ThreadParameters red_thread();

// Mean radiance straight from above for light on one side; from other samples than those of a bake.
Eigen::Array3d furnace(const station::ClothSample& cloth, bool light_above);

Eigen::Array3d mean_of(const cv::Mat3f& picture);

}  // namespace station_test
