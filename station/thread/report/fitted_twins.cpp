#include "station/thread/report/fitted_twins.h"

#include <algorithm>
#include <cmath>

#include "inversion/view/blocks.h"
#include "renderer/picture/image_file.h"
#include "station/session/results.h"
#include "station/thread/invert/invert_session.h"

namespace station {

Exposure exposure_of(const inversion::View& view, std::optional<int> stops) {
  const Eigen::Vector3d white = inversion::diffuser_radiance(view.light);
  Exposure exposure{.white = {white[0], white[1], white[2]}};
  exposure.stops = stops ? *stops : fitting_stops(view.image, exposure.white, view.mask);
  return exposure;
}

FittedTwins read_twins(const std::filesystem::path& session, const inversion::View& view, const std::string& model,
                       std::optional<int> stops) {
  FittedTwins twins{.photographed = cv::Mat3f(view.image.size(), cv::Vec3f(0, 0, 0)),
                    .fitted = renderer::read_exr(fitted_file_of(session, view.id, model)),
                    .exposure = exposure_of(view, stops),
                    .box = threads_box(view.mask)};
  view.image.copyTo(twins.photographed, view.mask);
  return twins;
}

cv::Mat3f residual_picture(const inversion::View& view, const FittedTwins& twins, int block_px) {
  // Where the residual is zero.
  const Eigen::Array3d grey =
      0.5 * std::exp2(-twins.exposure.stops) * Eigen::Map<const Eigen::Array3d>(twins.exposure.white.data());
  cv::Mat3f picture(twins.fitted.size(), cv::Vec3f(0, 0, 0));
  for (const inversion::Block& block : inversion::mask_blocks(view.mask, block_px)) {
    const Eigen::Array3d difference =
        grey + inversion::block_mean(block, twins.fitted) - inversion::block_mean(block, view.image);
    for (const cv::Point& at : block.pixels)
      for (int c = 0; c < 3; ++c) picture(at)[c] = static_cast<float>(std::max(0.0, difference[c]));
  }
  return picture;
}

}  // namespace station
