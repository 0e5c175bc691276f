#include "station/bench/calibrate/calibrate_camera.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "calibration/develop/develop.h"
#include "calibration/develop/linear_grey.h"
#include "calibration/geometry/chessboard.h"
#include "calibration/sensor/sensor_file.h"
#include "rig/devices/clock.h"
#include "station/bench/camera_adapter.h"
#include "station/documents/board_file.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/session_file.h"
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

std::vector<fs::path> pictures_in(const fs::path& folder) {
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

struct GreyPicture {
  cv::Mat1f linear;
  cv::Mat1b display;  // 8 bits, for people and for chessboards
};

GreyPicture read_picture(const fs::path& file) {
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

// The corners of one board in many pictures.
struct Seen {
  cv::Size size;
  std::vector<calibration::TagObservation> tags;
  std::vector<calibration::BoardPicture> chessboards;
  int with_board = 0, mirrored_with_board = 0;
};

void look_at(const GreyPicture& picture, const BoardFile& board, Seen& seen) {
  if (const auto* lattice = std::get_if<calibration::Lattice>(&board.pattern)) {
    const auto found = calibration::find_chessboard(picture.display, lattice->columns, lattice->rows);
    seen.chessboards.push_back(found.value_or(calibration::BoardPicture{}));
    seen.with_board += found ? 1 : 0;
    return;
  }
  seen.tags.push_back(calibration::detect_tags(picture.linear));
  seen.with_board += seen.tags.back().empty() ? 0 : 1;
  if (seen.with_board > 0) return;
  // A tag that was printed or photographed mirrored has no id: it is looked for only as long as nothing else was seen.
  cv::Mat1f mirrored;
  cv::flip(picture.linear, mirrored, 1);
  seen.mirrored_with_board += calibration::detect_tags(mirrored).empty() ? 0 : 1;
}

[[noreturn]] void refuse_unseen(const CalibrateCameraRequest& request, const BoardFile& board, const Seen& seen) {
  if (seen.mirrored_with_board > 0)
    throw std::runtime_error("the tags in " + request.images.string() +
                             " are mirrored, right and left exchanged: print the board again without mirroring, or "
                             "give pictures that were not flipped");
  if (const auto* lattice = std::get_if<calibration::Lattice>(&board.pattern))
    throw std::runtime_error("no picture in " + request.images.string() + " shows a whole chessboard of " +
                             std::to_string(lattice->rows) + " x " + std::to_string(lattice->columns) +
                             " inner corners; check rows and columns in " + request.board.string());
  throw std::runtime_error("no picture in " + request.images.string() +
                           " shows a tag (tag36h11); check focus, light and that this is the printed board");
}

}  // namespace

LensFile calibrate_camera(const CalibrateCameraRequest& request) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // broken files are reported by us
  const BoardFile board = read_board(request.board);
  const std::vector<fs::path> files = pictures_in(request.images);
  ProgressDisplay progress("calibrate camera", request.progress_style);
  Seen seen;
  LensFile result;
  for (const fs::path& file : files) {
    progress.show(static_cast<int>(result.pictures.size()), static_cast<int>(files.size()), file.filename().string());
    const GreyPicture picture = read_picture(file);
    if (seen.size.area() > 0 && picture.display.size() != seen.size)
      throw std::runtime_error(file.string() + " has " + std::to_string(picture.display.cols) + " x " +
                               std::to_string(picture.display.rows) + " pixels, " + files.front().filename().string() +
                               " has " + std::to_string(seen.size.width) + " x " + std::to_string(seen.size.height) +
                               "; a lens is calibrated from pictures of one size");
    seen.size = picture.display.size();
    look_at(picture, board, seen);
    result.pictures.push_back(file.filename().string());
    result.picture_sha256.push_back(sha256_of_file(file));
  }
  if (seen.with_board == 0) refuse_unseen(request, board, seen);
  const calibration::LensOptions options{.working_distance_mm = request.working_distance_mm,
                                         .taped_distance_mm = request.taped_distance_mm};
  const auto guess = [&](const std::vector<calibration::BoardPicture>& pictures, const calibration::Lattice& lattice) {
    return request.focal_guess_px > 0.0 ? request.focal_guess_px
                                        : calibration::guess_focal_px(pictures, lattice, seen.size);
  };
  if (const auto* lattice = std::get_if<calibration::Lattice>(&board.pattern)) {
    result.fit =
        calibration::fit_lens(seen.chessboards, *lattice, seen.size, guess(seen.chessboards, *lattice), options);
  } else {
    const auto& tags = std::get<calibration::TagLayout>(board.pattern);
    const calibration::TagLattice on = calibration::lattice_of(tags);
    std::vector<calibration::BoardPicture> pictures;
    for (const calibration::TagObservation& tagged : seen.tags)
      pictures.push_back(calibration::on_lattice(on, tags, tagged));
    result.fit = calibration::fit_lens(seen.tags, tags, seen.size, guess(pictures, on.lattice), options);
  }
  result.board = board.name;
  result.utc = rig::SystemClock().utc();
  result.software = software_version();
  write_json_file(request.out, to_json(result));
  write_cameramodel_beside(result.fit, request.out);
  progress.finish("done");
  return result;
}

}  // namespace station
