#include "station/cloth/pattern/picture_of_crossings.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "calibration/light/colour_chart.h"
#include "renderer/picture/image_file.h"

namespace station {

using Eigen::Vector3d;
namespace fs = std::filesystem;

cv::Mat3f picture_of_crossings(const fs::path& image, int asked_ends, double brightness,
                               const Eigen::Vector2d& crossing_mm, double most) {
  cv::Mat3f picture = renderer::read_linear_srgb(image);
  picture *= brightness;
  const int ends = asked_ends > 0 ? asked_ends : picture.cols;
  const double height_mm = ends * crossing_mm.x() * picture.rows / picture.cols,
               picks = std::max(1.0, std::round(height_mm / crossing_mm.y()));
  if (!(ends * picks <= most))
    throw std::runtime_error(image.string() + ": takes " + std::to_string(ends) + " x " +
                             std::to_string(static_cast<long long>(picks)) + " crossings, at most " +
                             std::to_string(static_cast<long long>(most)) + " are made; ask for fewer ends");
  cv::Mat3f resized;
  cv::resize(picture, resized, {ends, static_cast<int>(picks)}, 0, 0,
             ends < picture.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return resized;
}

Vector3d lab_of(const cv::Vec3f& linear_srgb) {
  return calibration::lab_of_linear_srgb(Vector3d(
      static_cast<double>(linear_srgb[0]), static_cast<double>(linear_srgb[1]), static_cast<double>(linear_srgb[2])));
}

cv::Mat1f colour_errors(const cv::Mat3f& a, const cv::Mat3f& b) {
  cv::Mat1f errors(a.size());
  errors.forEach([&](float& error, const int* at) {
    error = static_cast<float>(calibration::delta_e_2000(lab_of(a(at[0], at[1])), lab_of(b(at[0], at[1]))));
  });
  return errors;
}

cv::Mat3b panel_of(const cv::Mat3b& picture, double crossing_height) {
  constexpr double kPanel_px = 480;
  const double scale = kPanel_px / picture.cols;
  cv::Mat3b panel;
  cv::resize(picture, panel, {}, scale, scale * crossing_height, scale < 1 ? cv::INTER_AREA : cv::INTER_NEAREST);
  return panel;
}

}  // namespace station
