#include "renderer/picture/jpeg.h"

#include <turbojpeg.h>

#include <memory>
#include <stdexcept>

#include "renderer/picture/picture_bytes.h"

namespace renderer {
namespace {

using Coder = std::unique_ptr<void, int (*)(tjhandle)>;

}  // namespace

std::string encode_jpeg(const cv::Mat3b& rgb, int quality_percent) {
  const Coder coder(tjInitCompress(), tjDestroy);
  std::string bytes(tjBufSize(rgb.cols, rgb.rows, TJSAMP_420), '\0');
  auto* begin = reinterpret_cast<unsigned char*>(bytes.data());
  unsigned long size = bytes.size();
  if (tjCompress2(coder.get(), rgb.data, rgb.cols, static_cast<int>(rgb.step), rgb.rows, TJPF_RGB, &begin, &size,
                  TJSAMP_420, quality_percent, TJFLAG_NOREALLOC) != 0)
    throw std::runtime_error(tjGetErrorStr2(coder.get()));
  bytes.resize(size);
  return bytes;
}

cv::Mat3b decode_jpeg(std::string_view bytes, JpegDamage damage) {
  const Coder coder(tjInitDecompress(), tjDestroy);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, sampling = 0, colours = 0;
  if (tjDecompressHeader3(coder.get(), data, bytes.size(), &width, &height, &sampling, &colours) != 0)
    throw std::runtime_error(tjGetErrorStr2(coder.get()));
  if (colours == TJCS_CMYK || colours == TJCS_YCCK) throw std::runtime_error("it holds inks, not colours");
  if (static_cast<double>(width) * height > kMostPicturePixels) throw std::runtime_error("it has too many pixels");
  cv::Mat3b rgb(height, width);
  const bool strict = damage == JpegDamage::refused;
  if (tjDecompress2(coder.get(), data, bytes.size(), rgb.data, width, static_cast<int>(rgb.step), height, TJPF_RGB,
                    strict ? TJFLAG_STOPONWARNING : 0) != 0 &&
      (strict || tjGetErrorCode(coder.get()) == TJERR_FATAL))
    throw std::runtime_error(tjGetErrorStr2(coder.get()));
  return rgb;
}

}  // namespace renderer
