#include "station/bench/calibrate/board_pictures.h"

#include <turbojpeg.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "calibration/develop/develop.h"
#include "calibration/develop/linear_grey.h"
#include "calibration/sensor/sensor_file.h"
#include "station/bench/camera_adapter.h"
#include "station/documents/number_text.h"
#include "station/documents/text_pieces.h"

namespace station {
namespace {

namespace fs = std::filesystem;

enum class FileKind { photograph, raw, other };

FileKind kind_of(const fs::path& file) {
  const std::string extension = lower_case(file.extension().string());
  for (const char* known : {".jpg", ".jpeg", ".png", ".tif", ".tiff"})
    if (extension == known) return FileKind::photograph;
  return is_raw_file(file) ? FileKind::raw : FileKind::other;
}

// Display values (sRGB) back to linear ones: where edges of tags lie depends on it.
cv::Mat1f linear_from_display(const cv::Mat1f& display) {
  cv::Mat1f linear(display.size());
  std::transform(display.begin(), display.end(), linear.begin(),
                 [](float v) { return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F); });
  return linear;
}

cv::Mat1f display_from_linear(const cv::Mat1f& linear, float white) {
  cv::Mat1f display(linear.size());
  std::transform(linear.begin(), linear.end(), display.begin(),
                 [white](float v) { return std::pow(std::clamp(v / white, 0.F, 1.F), 1.F / 2.2F); });
  return display;
}

[[noreturn]] void refuse_damaged(const fs::path& file, const std::string& found) {
  throw std::runtime_error(file.string() + " breaks off or is damaged (" + found +
                           "); copy it from the camera again, or take it out of the folder");
}

// OpenCV fills what a JPEG file lacks with grey, and libpng writes to standard error, so both are looked at first.
void require_whole(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (bytes.starts_with("\x89PNG")) {
    if (bytes.find(std::string("IEND\xae\x42\x60\x82")) == std::string::npos) refuse_damaged(file, "no end of a PNG");
    return;
  }
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, sampling = 0, colours = 0;
  if (tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &sampling, &colours) != 0) return;
  std::vector<unsigned char> grey(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (tjDecompress2(decoder.get(), data, bytes.size(), grey.data(), width, 0, height, TJPF_GRAY, 0) != 0)
    refuse_damaged(file, tjGetErrorStr2(decoder.get()));
}

}  // namespace

std::vector<fs::path> board_pictures_in(const fs::path& folder) {
  if (!fs::is_directory(folder))
    throw std::runtime_error("no folder " + folder.string() +
                             "; give the folder of the board's pictures with --images");
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && kind_of(entry.path()) != FileKind::other) files.push_back(entry.path());
  if (files.empty())
    throw std::runtime_error("no pictures in " + folder.string() + "; expected JPEG, PNG, TIFF or raw files");
  std::sort(files.begin(), files.end());
  return files;
}

GreyPicture read_grey_picture(const fs::path& file) {
  GreyPicture picture;
  if (kind_of(file) == FileKind::raw) {
    picture.linear = calibration::linear_grey(calibration::read_sensor_file(file));
    double white = 0.0;
    cv::minMaxLoc(picture.linear, nullptr, &white);
    display_from_linear(picture.linear, std::max(1e-12F, static_cast<float>(white)))
        .convertTo(picture.display, CV_8U, 255.0);
    return picture;
  }
  require_whole(file);
  // As stored: a rotation written in EXIF would turn some pictures of one sensor and not others.
  const cv::Mat stored =
      cv::imread(file.string(), cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  if (stored.empty())
    throw std::runtime_error(file.string() +
                             " cannot be read as a picture; take it out of the folder or save it again");
  const double full = stored.depth() == CV_8U ? 255.0 : stored.depth() == CV_16U ? 65535.0 : 1.0;
  cv::Mat1f display;
  stored.convertTo(display, CV_32F, 1.0 / full);
  display.convertTo(picture.display, CV_8U, 255.0);
  picture.linear = stored.depth() == CV_32F ? display : linear_from_display(display);
  return picture;
}

std::string other_lens(const renderer::TakenWith& first, const renderer::TakenWith& second) {
  constexpr double kSame = 0.005;  // of a focal length, as cameras round it
  const auto differ = [](const std::string& a, const std::string& b) { return !a.empty() && !b.empty() && a != b; };
  if (differ(first.camera, second.camera)) return "was taken by " + second.camera + ", the first by " + first.camera;
  if (differ(first.lens, second.lens)) return "was taken with " + second.lens + ", the first with " + first.lens;
  const double a = first.focal_length_mm, b = second.focal_length_mm;
  if (a > 0 && b > 0 && std::abs(a - b) > kSame * a)
    return "was taken at " + number_text(b, 1) + " mm focal length, the first at " + number_text(a, 1) + " mm";
  return {};
}

}  // namespace station
