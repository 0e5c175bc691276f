#include "station/bench/calibrate/calibrate_camera.h"

#include <algorithm>
#include <map>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <stdexcept>
#include <utility>

#include "calibration/geometry/chessboard.h"
#include "rig/devices/clock.h"
#include "station/bench/calibrate/board_pictures.h"
#include "station/documents/board_file.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/session_file.h"

namespace station {
namespace {

namespace fs = std::filesystem;

// The corners of one board in many pictures.
struct Seen {
  cv::Size size;
  std::vector<calibration::TagObservation> tags;
  std::vector<calibration::BoardPicture> chessboards;
  int with_board = 0, mirrored_with_board = 0;
  std::map<int, int> repeated;  // tags that are there twice: in how many pictures
};

constexpr int kLargerLookedFor = 3;  // pictures

// A part of a chessboard is one too: the first pictures are searched for more rows and columns, in small, because the
// search takes seconds where it finds nothing in millions of pixels.
void require_no_larger(const GreyPicture& picture, const calibration::Lattice& board, const fs::path& file) {
  constexpr double kWidest_px = 1600;
  cv::Mat1b small = picture.display;
  if (const double scale = kWidest_px / std::max(small.cols, small.rows); scale < 1)
    cv::resize(picture.display, small, {}, scale, scale, cv::INTER_AREA);
  for (const auto& [rows, columns] :
       {std::pair(board.rows + 1, board.columns), std::pair(board.rows, board.columns + 1),
        std::pair(board.rows + 1, board.columns + 1)})
    if (calibration::find_chessboard(small, columns, rows))
      throw std::runtime_error(file.string() + " shows a chessboard of at least " + std::to_string(rows) + " x " +
                               std::to_string(columns) + " inner corners, the board file has " +
                               std::to_string(board.rows) + " x " + std::to_string(board.columns) +
                               "; correct rows and columns in it");
}

void look_at(const GreyPicture& picture, const BoardFile& board, const fs::path& file, Seen& seen) {
  if (const auto* lattice = std::get_if<calibration::Lattice>(&board.pattern)) {
    const auto found = calibration::find_chessboard(picture.display, lattice->columns, lattice->rows);
    if (found && seen.with_board < kLargerLookedFor) require_no_larger(picture, *lattice, file);
    seen.chessboards.push_back(found.value_or(calibration::BoardPicture{}));
    seen.with_board += found ? 1 : 0;
    return;
  }
  calibration::TagsSeen tags = calibration::see_tags(picture.linear);
  for (const int id : tags.repeated) ++seen.repeated[id];
  seen.tags.push_back(std::move(tags.tags));
  seen.with_board += seen.tags.back().empty() ? 0 : 1;
  if (seen.with_board > 0) return;
  // A tag that was printed or photographed mirrored has no id: it is looked for only as long as nothing else was seen.
  cv::Mat1f mirrored;
  cv::flip(picture.linear, mirrored, 1);
  seen.mirrored_with_board += calibration::detect_tags(mirrored).empty() ? 0 : 1;
}

std::string hash_of(const cv::Mat1b& picture) {  // which is continuous
  return sha256_hex(std::as_bytes(std::span(picture.data, picture.total())));
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

CalibratedCamera calibrate_camera(const CalibrateCameraRequest& request) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // broken files are reported by us
  const BoardFile board = read_board(request.board);
  const std::vector<fs::path> files = board_pictures_in(request.images);
  ProgressDisplay progress("calibrate camera", request.progress_style);
  Seen seen;
  CalibratedCamera calibrated;
  LensFile& result = calibrated.lens;
  const renderer::TakenWith first = renderer::taken_with(files.front());
  std::map<std::string, std::string> names;  // of pictures by their pixels' hash
  int done = 0;
  for (const fs::path& file : files) {
    progress.show(done++, static_cast<int>(files.size()), file.filename().string());
    if (const std::string other = other_lens(first, renderer::taken_with(file)); !other.empty())
      throw std::runtime_error(file.string() + " " + other + " (" + files.front().filename().string() +
                               "); a lens is calibrated from the pictures of one camera and lens: sort them into "
                               "folders");
    const GreyPicture picture = read_grey_picture(file);
    if (seen.size.area() > 0 && picture.display.size() != seen.size)
      throw std::runtime_error(file.string() + " has " + std::to_string(picture.display.cols) + " x " +
                               std::to_string(picture.display.rows) + " pixels, " + files.front().filename().string() +
                               " has " + std::to_string(seen.size.width) + " x " + std::to_string(seen.size.height) +
                               "; a lens is calibrated from pictures of one size");
    seen.size = picture.display.size();
    const auto [same, is_new] = names.emplace(hash_of(picture.display), file.filename().string());
    if (!is_new) {
      calibrated.remarks.push_back(file.filename().string() + " is the same picture as " + same->second +
                                   " and does not count");
      continue;
    }
    look_at(picture, board, file, seen);
    result.pictures.push_back(file.filename().string());
    result.picture_sha256.push_back(sha256_of_file(file));
  }
  if (seen.with_board == 0) refuse_unseen(request, board, seen);
  for (const auto& [id, times] : seen.repeated)
    calibrated.remarks.push_back("tag " + std::to_string(id) + " is there twice in " + std::to_string(times) + " of " +
                                 std::to_string(result.pictures.size()) +
                                 " pictures, which leave it out: is it printed twice, or does another board with it "
                                 "stand in the picture?");
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
    if (const std::string beside = calibration::tags_beside(tags, seen.tags); !beside.empty())
      throw std::runtime_error(beside + " are printed on the board but not in " + request.board.string() +
                               "; correct its rows, columns and first_id");
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
  return calibrated;
}

}  // namespace station
