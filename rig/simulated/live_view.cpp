#include "rig/simulated/live_view.h"

#include <turbojpeg.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace rig {

std::string live_view_jpeg(const cv::Mat3f& radiance) {
  float brightest = 1e-6F;
  for (const cv::Vec3f& pixel : radiance) brightest = std::max({brightest, pixel[0], pixel[1], pixel[2]});
  cv::Mat3b shown(radiance.size());
  std::transform(radiance.begin(), radiance.end(), shown.begin(), [&](const cv::Vec3f& pixel) {
    const auto tone = [&](float value) {
      return cv::saturate_cast<unsigned char>(255 * std::pow(std::max(value, 0.0F) / brightest, 1 / 2.2F));
    };
    return cv::Vec3b(tone(pixel[0]), tone(pixel[1]), tone(pixel[2]));
  });
  constexpr int kQuality_percent = 95;
  const std::unique_ptr<void, int (*)(tjhandle)> coder(tjInitCompress(), tjDestroy);
  std::string bytes(tjBufSize(shown.cols, shown.rows, TJSAMP_420), '\0');
  auto* begin = reinterpret_cast<unsigned char*>(bytes.data());
  unsigned long size = bytes.size();
  if (tjCompress2(coder.get(), shown.data, shown.cols, 0, shown.rows, TJPF_RGB, &begin, &size, TJSAMP_420,
                  kQuality_percent, TJFLAG_NOREALLOC) != 0)
    throw std::runtime_error(tjGetErrorStr2(coder.get()));
  bytes.resize(size);
  return bytes;
}

}  // namespace rig
