// The noise of a rendering taken away for looking at it, never for measuring: what comes out is smoother than it is
// true.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "renderer/picture/film.h"

namespace renderer {

// What is known of a noisy picture. All planes have its size.
struct NoisyPicture {
  cv::Mat3f mean;                     // radiance, RGB
  cv::Mat1f variance;                 // of that mean, the three colours together; it may be noisy itself
  std::vector<cv::Mat1f> features{};  // of what is seen there, with little noise, in any units: albedo, normal, ...
};

// Of a film, or of two of the same picture with seeds of their own, so that the noise is known from the first sample
// on; without features. Errors: std::invalid_argument for a single film with pixels of a single batch, whose noise it
// does not know, and for two of different sizes.
NoisyPicture noisy_picture(const Film& film);
NoisyPicture noisy_picture(const Film& one, const Film& other);

// Around each pixel the radiance is taken to be linear in the features and the place, over windows of three sizes
// [Moon 2014, doi 10.1145/2641762; their coefficients averaged as by He 2013, doi 10.1109/TPAMI.2012.213]. Where which
// of them, or the noisy picture itself, is nearest to the truth is judged by Stein's unbiased estimate of the error
// [Stein 1981, doi 10.1214/aos/1176345632], so that what has no noise stays as it is. Never negative; the same picture
// for any number of threads. Errors: std::invalid_argument for planes of another size, and for more than 10 features.
cv::Mat3f denoised(const NoisyPicture& picture);

}  // namespace renderer
