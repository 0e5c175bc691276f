#include "station/bench/calibrate/board_pictures.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calibration/develop/linear_grey.h"
#include "calibration/sensor/sensor_file.h"
#include "renderer/picture/image_file.h"
#include "renderer/picture/srgb.h"
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

cv::Mat1f display_from_linear(const cv::Mat1f& linear, float white) {
  cv::Mat1f display(linear.size());
  std::transform(linear.begin(), linear.end(), display.begin(),
                 [white](float v) { return std::pow(std::clamp(v / white, 0.F, 1.F), 1.F / 2.2F); });
  return display;
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
  // As stored: a rotation written in EXIF would turn some pictures of one sensor and not others.
  cv::cvtColor(renderer::read_photograph(file), picture.linear, cv::COLOR_RGB2GRAY);
  picture.display.create(picture.linear.size());
  std::transform(picture.linear.begin(), picture.linear.end(), picture.display.begin(), [](float v) {
    return cv::saturate_cast<uchar>(255 * renderer::srgb_encoded(std::clamp(v, 0.F, 1.F)));
  });
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
