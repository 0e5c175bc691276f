// The agreement of rendered views with the photographed ones: relative root mean square error over the blocks of the
// mask (blocks.h), each weighted by its masked pixels.
#pragma once

#include <array>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "inversion/view/view.h"

namespace inversion {

struct ViewAgreement {
  double mean_square = 0;     // of (rendered - photographed block averages) / diffuser's radiance, mean of RGB
  double mean_reference = 0;  // of photographed block averages / diffuser's radiance, mean of RGB
  // The same of each channel over the diffuser's own: the colour of the photographed threads.
  Eigen::Array3d mean_colour = Eigen::Array3d::Zero();
  double relative_rmse() const;                         // root of mean_square over mean_reference
  double relative_bias = 0;                             // mean of the difference over the mean of the photograph
  Eigen::Array3d colour_bias = Eigen::Array3d::Zero();  // the same of each channel by itself
};

// The agreement of a rendering with the view's photograph. `rendered` has the size and radiance unit of view.image;
// blocks are block_px wide.
ViewAgreement agreement(const View& view, const cv::Mat3f& rendered, int block_px);

// The same from two photographs and two renderings whose noise is independent: mean_square is the mean of (R_1 -
// P_1)(R_2 - P_2), which has no part of the noise of either and may be below zero. view.image is not used.
ViewAgreement noiseless_agreement(const View& view, const std::array<cv::Mat3f, 2>& photographs,
                                  const std::array<cv::Mat3f, 2>& rendered, int block_px);

// The relative error of all views together: the root of the mean of their mean squares over the mean of their means, so
// that every view counts alike, as in eq. 6.
double overall_relative_rmse(const std::vector<ViewAgreement>& views);

// The picture of the view that the path tracer makes of the fitted thread, by paths that the fit never saw; radiance
// unit, black outside the mask. progress: see renderer::RenderOptions.
cv::Mat3f fitted_view(const WrappedSpool& spool, const View& view, const renderer::ScatteringModel& thread,
                      int samples_per_pixel, std::uint64_t seed, const std::function<bool(double)>& progress = {});

// The same of these threads (shaded_threads()) in place of even ones.
cv::Mat3f fitted_view(const WrappedSpool& spool, const View& view, std::vector<renderer::CurveSet> threads,
                      int samples_per_pixel, std::uint64_t seed, const std::function<bool(double)>& progress = {});

}  // namespace inversion
