#include "station/output/display.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "renderer/picture/image_file.h"

namespace station {

double display_scale(const cv::Mat3f& linear, const cv::Mat1b& mask) {
  constexpr double kWhite = 0.85;
  std::vector<float> brightest;
  for (int row = 0; row < linear.rows; ++row)
    for (int column = 0; column < linear.cols; ++column) {
      const cv::Vec3f& p = linear(row, column);
      if (mask.empty() || mask(row, column)) brightest.push_back(std::max({p[0], p[1], p[2]}));
    }
  if (brightest.empty()) return 1.0;
  const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(brightest.size() - 1));
  std::nth_element(brightest.begin(), brightest.begin() + rank, brightest.end());
  const double level = brightest[static_cast<std::size_t>(rank)];
  return level > 0 ? kWhite / level : 1.0;
}

cv::Rect threads_box(const cv::Mat1b& mask, int margin_px) {
  const cv::Rect whole(0, 0, mask.cols, mask.rows);
  const cv::Rect box = cv::boundingRect(mask);
  if (box.empty()) return whole;
  const double share = std::min(
      1.0, std::max((box.width + 2.0 * margin_px) / whole.width, (box.height + 2.0 * margin_px) / whole.height));
  const int width = cvRound(share * whole.width), height = cvRound(share * whole.height);
  return {std::clamp(box.x + (box.width - width) / 2, 0, whole.width - width),
          std::clamp(box.y + (box.height - height) / 2, 0, whole.height - height), width, height};
}

int fitting_stops(const cv::Mat3f& linear, const std::array<double, 3>& white, const cv::Mat1b& mask) {
  constexpr double kMost = 12;
  cv::Mat3f over_white;
  cv::multiply(linear, cv::Scalar(1 / white[0], 1 / white[1], 1 / white[2]), over_white);
  return static_cast<int>(std::clamp(std::floor(std::log2(display_scale(over_white, mask))), -kMost, kMost));
}

std::string describe(const Exposure& exposure) {
  if (exposure.stops == 0) return "a white card is white";
  const int stops = std::abs(exposure.stops);
  return "a white card is white, then " + std::to_string(stops) + (stops == 1 ? " stop " : " stops ") +
         (exposure.stops > 0 ? "brighter" : "darker");
}

cv::Mat3b display(const cv::Mat3f& linear, const Exposure& exposure,
                  const std::array<double, 9>& linear_srgb_from_camera) {
  std::array<double, 9> exposed = linear_srgb_from_camera;
  for (std::size_t i = 0; i < exposed.size(); ++i) exposed.at(i) /= exposure.white.at(i % exposure.white.size());
  return display(linear, std::exp2(exposure.stops), exposed);
}

cv::Mat3b display(const cv::Mat3f& linear, double scale, const std::array<double, 9>& linear_srgb_from_camera) {
  cv::Matx33f matrix;
  std::copy(linear_srgb_from_camera.begin(), linear_srgb_from_camera.end(), matrix.val);
  return renderer::encode_srgb(linear, scale, matrix);
}

cv::Mat3b display(const cv::Mat3f& linear, const std::array<double, 9>& linear_srgb_from_camera) {
  return display(linear, display_scale(linear), linear_srgb_from_camera);
}

void draw_outline(cv::Mat3b& picture, const cv::Mat1b& mask) {
  cv::Mat1b inner;
  cv::erode(mask, inner, cv::Mat());
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column)
      if (mask(row, column) && !inner(row, column)) picture(row, column) = cv::Vec3b(0, 255, 80);
}

}  // namespace station
