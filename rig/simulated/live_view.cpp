#include "rig/simulated/live_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <vector>

namespace rig {

std::string live_view_jpeg(const cv::Mat3f& radiance) {
  float brightest = 1e-6F;
  for (const cv::Vec3f& pixel : radiance) brightest = std::max({brightest, pixel[0], pixel[1], pixel[2]});
  cv::Mat3b shown(radiance.size());
  std::transform(radiance.begin(), radiance.end(), shown.begin(), [&](const cv::Vec3f& pixel) {
    const auto tone = [&](float value) {
      return cv::saturate_cast<unsigned char>(255 * std::pow(std::max(value, 0.0F) / brightest, 1 / 2.2F));
    };
    return cv::Vec3b(tone(pixel[2]), tone(pixel[1]), tone(pixel[0]));
  });
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", shown, bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace rig
