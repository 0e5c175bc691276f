// A comparison of two scenes that should look alike, drawn with the same seeds: light paths that meet the same surfaces
// are the same ones, so that the difference of the pictures is far less noisy than either.
#pragma once

#include <opencv2/core.hpp>

#include "renderer/picture/camera.h"
#include "renderer/scene/scene.h"

namespace renderer {

struct PictureComparison {
  cv::Vec3d ratio;           // ratio of mean radiances, first scene to second, RGB
  cv::Vec3d standard_error;  // that of the ratio, from the spread of the differences over seeds
  // The mean over 8 x 8 blocks of the picture of (mean difference / its standard error)^2; noise alone gives
  // `expected_structure` +- `structure_deviation` (one standard deviation).
  double structure = 0, expected_structure = 0, structure_deviation = 0;
  double largest_block = 0;  // largest mean difference of a block over the mean radiance
};

// Draws `pictures` pictures of each scene, with seeds 1, 2, ..., and compares them.
PictureComparison compare_pictures(const Scene& first, const Scene& second, const Camera& camera, int samples_per_pixel,
                                   int pictures = 16);

}  // namespace renderer
