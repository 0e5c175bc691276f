#include "station/session/develop/develop_measured.h"

#include <cmath>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "station/session/develop/view_files.h"

namespace station {
namespace {

constexpr const char* kMeasured =
    "linear RGB as it was measured; to be divided by the view's lamp_strength in views.json";

// Measured pictures have values beside the threads that are no numbers of light, such as -1.
void require_light(const inversion::View& view) {
  for (int row = 0; row < view.mask.rows; ++row)
    for (int column = 0; column < view.mask.cols; ++column)
      for (const float value : view.image(row, column).val)
        if (view.mask(row, column) && !std::isfinite(value))
          throw std::runtime_error("view " + view.id + ": column " + std::to_string(column) + ", row " +
                                   std::to_string(row) +
                                   " of its picture, within the mask, is no number; mask it out, or measure it again");
}

}  // namespace

DevelopedViews develop_measured(const std::filesystem::path& session, const SessionFile& asked,
                                ProgressStyle progress_style) {
  ProgressDisplay progress("develop", progress_style);
  DevelopedViews developed = *asked.measured;
  int done = 0;
  for (DevelopedView& next : developed.views) {
    inversion::View& view = next.view;
    progress.show(done++, static_cast<int>(developed.views.size()), view.id);
    view.image = renderer::read_linear(session / next.image_file);
    view.mask = next.mask_file.empty()
                    ? inversion::thread_mask(asked.spool.wrapping, view.camera, view.light, kMaskSamples)
                    : cv::Mat1b(renderer::read_png_grey(session / next.mask_file) > 127);
    next.masked_pixels = cv::countNonZero(view.mask);
    if (next.masked_pixels == 0)
      throw std::runtime_error(
          "view " + view.id +
          ": no thread is where its directions put it; check its angles, distance and focal length");
    require_light(view);
    next.image_file = image_file_of(view.id);
    next.mask_file = mask_file_of(view.id);
    write_view(session, next, kMeasured, developed.linear_srgb_from_camera);
    view.image.release();
    view.mask.release();
  }
  progress.finish(std::to_string(developed.views.size()) + " views");
  return developed;
}

}  // namespace station
