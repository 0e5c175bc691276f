// The noise of a developed view as a law: variance of a pixel = floor + slope x radiance, each channel by itself. Two numbers
// say what the whole plane of variances does: photons bring the slope, reading the floor, and exposures merged and a flat
// field lie between within a few percent.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

namespace inversion {

struct NoiseLaw {
  Eigen::Array3d floor = Eigen::Array3d::Zero();  // radiance unit squared
  Eigen::Array3d slope = Eigen::Array3d::Zero();  // radiance unit
};

// Least squares over the masked pixels; nothing when `variance` is empty or no pixel is masked.
std::optional<NoiseLaw> noise_law(const cv::Mat3f& radiance, const cv::Mat3f& variance, const cv::Mat1b& mask);

// Variance by the law of a pixel with that radiance; below 0 it has the floor's. What a law says of the mean of many pixels it
// says of the mean of their variances.
Eigen::Array3d variance_by(const NoiseLaw& law, const Eigen::Array3d& radiance);

// The law of the picture divided by `divisor`.
NoiseLaw divided(const NoiseLaw& law, double divisor);

}  // namespace inversion
