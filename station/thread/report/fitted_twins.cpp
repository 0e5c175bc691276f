#include "station/thread/report/fitted_twins.h"

#include <algorithm>

#include "inversion/view/blocks.h"
#include "renderer/picture/image_file.h"
#include "station/output/display.h"
#include "station/session/results.h"
#include "station/thread/invert/invert_session.h"

namespace station {

FittedTwins read_twins(const std::filesystem::path& session, const inversion::View& view, const std::string& model) {
  FittedTwins twins{.photographed = cv::Mat3f(view.image.size(), cv::Vec3f(0, 0, 0)),
                    .fitted = renderer::read_exr(fitted_file_of(session, view.id, model)),
                    .scale = display_scale(view.image, view.mask),
                    .box = threads_box(view.mask)};
  view.image.copyTo(twins.photographed, view.mask);
  return twins;
}

cv::Mat3f residual_picture(const inversion::View& view, const FittedTwins& twins, int block_px) {
  constexpr double kGrey = 0.5;  // where the residual is zero
  cv::Mat3f picture(twins.fitted.size(), cv::Vec3f(0, 0, 0));
  for (const inversion::Block& block : inversion::mask_blocks(view.mask, block_px)) {
    const Eigen::Array3d difference =
        kGrey / twins.scale + inversion::block_mean(block, twins.fitted) - inversion::block_mean(block, view.image);
    for (const cv::Point& at : block.pixels)
      for (int c = 0; c < 3; ++c) picture(at)[c] = static_cast<float>(std::max(0.0, difference[c]));
  }
  return picture;
}

}  // namespace station
