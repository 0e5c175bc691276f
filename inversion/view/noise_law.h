// The noise of a developed view as a law: variance of a pixel = floor + slope x radiance, each channel by itself. The
// two numbers stand for the whole plane of variances: photons give the slope, reading the floor; merged exposures and a
// flat field deviate by a few percent.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

namespace inversion {

struct NoiseLaw {
  Eigen::Array3d floor = Eigen::Array3d::Zero();  // radiance unit squared
  Eigen::Array3d slope = Eigen::Array3d::Zero();  // radiance unit
};

// The law by least squares over the masked pixels; nothing when `variance` is empty or no pixel is masked.
std::optional<NoiseLaw> noise_law(const cv::Mat3f& radiance, const cv::Mat3f& variance, const cv::Mat1b& mask);

// The variance by the law of a pixel with that radiance; below 0 it is the floor's. Because the law is linear, it gives
// the mean variance of many pixels from their mean radiance.
Eigen::Array3d variance_by(const NoiseLaw& law, const Eigen::Array3d& radiance);

// The law of the picture divided by `divisor`.
NoiseLaw divided(const NoiseLaw& law, double divisor);

}  // namespace inversion
