// Lens calibration from existing pictures of a printed board.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "station/documents/lens_file.h"
#include "station/output/progress.h"

namespace station {

struct CalibrateCameraRequest {
  std::filesystem::path images, board, out;
  double focal_guess_px = 0.0;       // 0: from the pictures' perspective
  double working_distance_mm = 0.0;  // 0: the pictures' median distance
  double taped_distance_mm = 0.0;    // typical distance of the board by tape measure; 0: not known
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct CalibratedCamera {
  LensFile lens;
  std::vector<std::string> remarks;  // what a person should know of the pictures, a line each
};

// Reads every picture of the folder (JPEG, PNG, TIFF, raw), writes <out> and the .cameramodel beside it, also when an
// acceptance check failed: the caller says so. Throws std::runtime_error when there is nothing to solve,
// a picture is damaged or of another camera or lens, or the board is not that of the file.
CalibratedCamera calibrate_camera(const CalibrateCameraRequest& request);

}  // namespace station
