#include "renderer/picture/image_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "renderer/picture/decoded_picture.h"
#include "renderer/picture/jpeg.h"
#include "renderer/picture/picture_bytes.h"
#include "renderer/picture/srgb.h"

namespace renderer {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExrBegin = "\x76\x2f\x31\x01";

cv::Mat3f linear_of_jpeg(const std::string& bytes, const fs::path& file) {
  try {
    cv::Mat4b rgba;
    cv::cvtColor(decode_jpeg(bytes), rgba, cv::COLOR_RGB2RGBA);
    return linear_over_white(rgba);
  } catch (const std::runtime_error& problem) {
    refuse_damaged_picture(file, problem.what());
  }
}

cv::Mat3f linear_of_exr(const fs::path& file, bool over_white) {
  std::map<std::string, cv::Mat> planes;
  for (const ExrChannel& channel : read_exr_channels(file)) planes[channel.name] = channel.plane;
  const bool grey = planes.contains("Y") && !planes.contains("R");
  std::array<cv::Mat, 3> colours;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name = grey ? "Y" : std::string(1, "RGB"[c]);
    if (!planes.contains(name))
      refuse_picture("reading picture " + file.string(), "it has no channel " + name, "give a grey or colour picture");
    planes[name].convertTo(colours[c], CV_32F);
  }
  cv::Mat3f linear;
  cv::merge(colours, linear);
  if (over_white && planes.contains("A")) {
    const cv::Mat1f opacity = planes["A"];
    linear.forEach([&](cv::Vec3f& pixel, const int* at) {
      pixel += cv::Vec3f::all(1 - std::clamp(opacity(at[0], at[1]), 0.0f, 1.0f));
    });
  }
  const bool finite = std::all_of(linear.begin(), linear.end(), [](const cv::Vec3f& pixel) {
    return std::isfinite(pixel[0]) && std::isfinite(pixel[1]) && std::isfinite(pixel[2]);
  });
  if (!finite) refuse_picture("reading picture " + file.string(), "it has values that are no numbers", "make it again");
  return linear;
}

template <class Channel>
cv::Mat3f over_white(const cv::Mat_<cv::Vec<Channel, 4>>& rgba) {
  constexpr int kMost = std::numeric_limits<Channel>::max();
  std::vector<float> decoded(kMost + 1);
  for (int i = 0; i <= kMost; ++i)
    decoded[static_cast<std::size_t>(i)] = srgb_decoded(static_cast<float>(i) / static_cast<float>(kMost));
  cv::Mat3f linear(rgba.size());
  linear.forEach([&](cv::Vec3f& pixel, const int* at) {
    const auto& shown = rgba(at[0], at[1]);
    const float alpha = static_cast<float>(shown[3]) / static_cast<float>(kMost);
    for (int c = 0; c < 3; ++c) pixel[c] = alpha * decoded[shown[c]] + (1 - alpha);
  });
  return linear;
}

bool is_tiff(std::string_view bytes) {
  using namespace std::string_view_literals;
  return bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv);
}

// None of the libraries is let near a file that does not begin as its own do.
cv::Mat3f linear_of(const std::string& bytes, const fs::path& file) {
  if (bytes.starts_with("\x89PNG")) return linear_of_png(bytes, file);
  if (bytes.starts_with("\xff\xd8\xff")) return linear_of_jpeg(bytes, file);
  if (bytes.starts_with(kExrBegin)) return linear_of_exr(file, true);
  refuse_picture("reading picture " + file.string(), "it is none of PNG, JPEG and EXR", "give one of these");
}

}  // namespace

void check_size(const fs::path& file, double width, double height) {
  if (width * height > kMostPicturePixels)
    refuse_picture(
        "reading picture " + file.string(),
        "it has " + std::to_string(std::lround(width)) + " x " + std::to_string(std::lround(height)) + " pixels",
        "give one of at most 100 million");
}

cv::Mat3f linear_over_white(const cv::Mat4b& rgba) {
  return over_white(rgba);
}
cv::Mat3f linear_over_white(const cv::Mat4w& rgba) {
  return over_white(rgba);
}

cv::Mat3f read_linear_srgb(const fs::path& file) {
  return linear_of(bytes_of_picture(file), file);
}

cv::Mat3f read_photograph(const fs::path& file) {
  const std::string bytes = bytes_of_picture(file);
  return is_tiff(bytes) ? linear_of_tiff(file) : linear_of(bytes, file);
}

cv::Mat3f read_linear(const fs::path& file) {
  const std::string bytes = bytes_of_picture(file);
  if (is_tiff(bytes)) return light_of_tiff(file);
  if (bytes.starts_with(kExrBegin)) return linear_of_exr(file, false);
  refuse_picture("reading picture " + file.string(), "it is neither EXR nor TIFF",
                 "give linear pictures, EXR or TIFF of floats or 16 bits");
}

cv::Mat3b encode_srgb(const cv::Mat3f& linear, double scale, const cv::Matx33f& linear_srgb_from_camera) {
  cv::Mat3b encoded(linear.size());
  const cv::Matx33f matrix = linear_srgb_from_camera * static_cast<float>(scale);
  encoded.forEach([&](cv::Vec3b& pixel, const int* position) {
    const cv::Vec3f value = matrix * linear(position[0], position[1]);
    for (int c = 0; c < 3; ++c) {
      const float clipped = std::isnan(value[c]) ? 0.0f : std::clamp(value[c], 0.0f, 1.0f);
      pixel[c] = static_cast<uchar>(std::lround(255 * srgb_encoded(clipped)));
    }
  });
  return encoded;
}

cv::Vec3f linear_of_srgb(const cv::Vec3b& shown) {
  cv::Vec3f linear;
  for (int c = 0; c < 3; ++c) linear[c] = srgb_decoded(static_cast<float>(shown[c]) / 255);
  return linear;
}

}  // namespace renderer
