#include "inversion/view/agreement.h"

#include <cmath>

#include "inversion/view/blocks.h"
#include "renderer/trace/path_tracer.h"

namespace inversion {

double ViewAgreement::relative_rmse() const {
  return std::copysign(std::sqrt(std::abs(mean_square)), mean_square) / mean_reference;
}

ViewAgreement noiseless_agreement(const View& view, const std::array<cv::Mat3f, 2>& photographs,
                                  const std::array<cv::Mat3f, 2>& rendered, int block_px) {
  const double diffuser = diffuser_radiance(view.light).mean();
  ViewAgreement result;
  double pixels = 0;
  Eigen::Array3d difference_sum = Eigen::Array3d::Zero(), reference_sum = difference_sum;
  for (const Block& block : mask_blocks(view.mask, block_px)) {
    const auto weight = static_cast<double>(block.pixels.size());
    std::array<Eigen::Array3d, 2> difference;
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Array3d reference = block_mean(block, photographs[i]) / diffuser;
      difference[i] = block_mean(block, rendered[i]) / diffuser - reference;
      reference_sum += 0.5 * weight * reference;
      difference_sum += 0.5 * weight * difference[i];
    }
    result.mean_square += weight * (difference[0] * difference[1]).mean();
    pixels += weight;
  }
  result.relative_bias = difference_sum.sum() / reference_sum.sum();
  result.colour_bias = difference_sum / reference_sum;
  result.mean_square /= pixels;
  result.mean_reference = reference_sum.mean() / pixels;
  result.mean_colour = reference_sum / pixels * diffuser / diffuser_radiance(view.light).array();
  return result;
}

ViewAgreement agreement(const View& view, const cv::Mat3f& rendered, int block_px) {
  return noiseless_agreement(view, {view.image, view.image}, {rendered, rendered}, block_px);
}

double overall_relative_rmse(const std::vector<ViewAgreement>& views) {
  double squares = 0, references = 0;
  for (const ViewAgreement& view : views) {
    squares += view.mean_square;
    references += view.mean_reference;
  }
  const auto count = static_cast<double>(views.size());
  return std::copysign(std::sqrt(std::abs(squares / count)), squares) / (references / count);
}

cv::Mat3f fitted_view(const WrappedSpool& spool, const View& view, const renderer::ScatteringModel& thread,
                      int samples_per_pixel, std::uint64_t seed, const std::function<bool(double)>& progress) {
  return fitted_view(spool, view, std::vector{aligned_threads(spool, thread)}, samples_per_pixel, seed, progress);
}

cv::Mat3f fitted_view(const WrappedSpool& spool, const View& view, std::vector<renderer::CurveSet> threads,
                      int samples_per_pixel, std::uint64_t seed, const std::function<bool(double)>& progress) {
  const renderer::PathTracer tracer(view_scene(spool, std::move(threads), view.light));
  renderer::RenderOptions options{.samples_per_pixel = samples_per_pixel, .seed = seed};
  options.only = view.mask;
  options.progress = progress;
  return tracer.render(view.camera, options);
}

}  // namespace inversion
