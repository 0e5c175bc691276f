// How well rendered views agree with the photographed ones: relative root mean square error over the blocks of the
// mask (blocks.h), each weighted by its masked pixels.
#pragma once

#include <array>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "inversion/view.h"

namespace inversion {

struct ViewAgreement {
  double mean_square = 0;  // of rendered minus photographed block averages, mean of RGB, over the diffuser's radiance
  double mean_reference = 0;     // of the photographed block averages, mean of RGB, over the diffuser's radiance
  double relative_rmse() const;  // root of the first over the second
  double relative_bias = 0;      // mean of the difference over the mean of the photograph
  Eigen::Array3d colour_bias = Eigen::Array3d::Zero();  // the same of each channel by itself
};

// `rendered` as view.image: same size and radiance unit. Blocks of block_px.
ViewAgreement agreement(const View& view, const cv::Mat3f& rendered, int block_px);

// The same from two photographs and two renderings whose noise is independent: mean_square is the mean of (R_1 - P_1)(R_2 - P_2),
// which has no part of the noise of either and may be below zero; view.image is not used.
ViewAgreement noiseless_agreement(const View& view, const std::array<cv::Mat3f, 2>& photographs,
                                  const std::array<cv::Mat3f, 2>& rendered, int block_px);

// Of all views together: root of the mean of their mean squares over the mean of their means, so that every view counts
// alike, as in eq. 6.
double overall_relative_rmse(const std::vector<ViewAgreement>& views);

// The view as its fitted thread gives it, by the path tracer with paths of its own (the fit never saw them); radiance
// unit, black outside the mask. progress: see renderer::RenderOptions.
cv::Mat3f fitted_view(const WrappedSpool& spool, const View& view, const renderer::ScatteringModel& thread,
                      int samples_per_pixel, std::uint64_t seed, const std::function<bool(double)>& progress = {});

}  // namespace inversion
