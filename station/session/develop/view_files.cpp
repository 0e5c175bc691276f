#include "station/session/develop/view_files.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/image_file.h"
#include "station/output/display.h"

namespace station {
namespace {

cv::Mat3b overlay(const inversion::View& view, const std::array<double, 9>& colour) {
  constexpr int kMargin_px = 24, kWidest_px = 1200;
  const cv::Rect box = threads_box(view.mask, kMargin_px);
  cv::Mat3f part = view.image(box).clone();
  cv::Mat1b mask = view.mask(box).clone();
  if (box.width > kWidest_px) {
    const cv::Size size(kWidest_px, std::max(1, box.height * kWidest_px / box.width));
    cv::resize(part, part, size, 0, 0, cv::INTER_AREA);
    cv::resize(mask, mask, size, 0, 0, cv::INTER_NEAREST);
  }
  cv::Mat3b picture = display(part, display_scale(part, mask), colour);
  draw_outline(picture, mask);
  return picture;
}

}  // namespace

std::string image_file_of(const std::string& view) {
  return "linear/" + view + ".exr";
}

std::string mask_file_of(const std::string& view) {
  return "masks/" + view + ".png";
}

void write_view(const std::filesystem::path& session, const DevelopedView& developed, const std::string& content,
                const std::array<double, 9>& linear_srgb_from_camera) {
  const inversion::View& view = developed.view;
  // Zip would make noisy pictures only 6 % smaller and take seconds for each of 24 MP.
  renderer::write_exr(session / developed.image_file, view.image,
                      {{"threadstation/content", content}, {"threadstation/view", view.id}},
                      renderer::ExrCompression::none);
  renderer::write_png(session / developed.mask_file, view.mask);
  renderer::write_png(session / "masks" / (view.id + "-overlay.png"), overlay(view, linear_srgb_from_camera));
}

}  // namespace station
