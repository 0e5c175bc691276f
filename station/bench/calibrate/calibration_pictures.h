// The pictures of a rig calibration: taken step by step into a folder, listed with their hashes, read back.
//
// The folder has pictures/<id>.arw as delivered, and pictures.json ("threadstation/calibration_pictures"), which is
// written anew after each picture, so that an interrupted calibration goes on where it stood.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "station/bench/calibrate/calibration_plan.h"
#include "station/bench/calibrate/lens_coverage.h"
#include "station/bench/rig_devices.h"

namespace station {

struct CalibrationPicture {
  std::string id;
  CalibrationRole role = CalibrationRole::lens;
  std::string file;  // relative to the folder
  std::string sha256;
  double reading_rad = 0.0;  // of the turntable
  double exposure_s = 0.0;   // as the camera read it back
  std::string exposure_of;   // as CalibrationStep; pictures of one series name the same
  std::string utc;           // when the exposure began
  // The lamp's output over its nominal one, as a reference chip in the picture tells it; none where it was not read.
  std::optional<double> lamp_output = std::nullopt;
};

using StepProgress = std::function<void(int done, int total, const std::string& label)>;

// Takes the pictures that `plan` asks for and the folder does not hold yet; steps that turn out not to be needed are
// taken off the plan. Where a step follows its target, a picture is taken first to see how it stands. `should_stop` is
// polled between steps; when it is true the platform is stopped and std::runtime_error thrown. `covered` learns what
// the lens pictures show of the board.
std::vector<CalibrationPicture> record_calibration(const RigFile& rig, std::vector<CalibrationStep>& plan,
                                                   RigDevices& devices, const std::filesystem::path& folder,
                                                   const StepProgress& progress,
                                                   const std::function<bool()>& should_stop, LensCoverage& covered);

// Takes pictures of these roles off the list, so that record_calibration takes them again. Does nothing when there is
// no list.
void forget_calibration_pictures(const std::filesystem::path& folder,
                                 const std::function<bool(CalibrationRole)>& forget);

// Since when all that the pictures measure is known: when the last one was taken of the part that is the oldest.
// Neither to solve old pictures again nor to take a part of them again makes the others younger. Empty without
// pictures.
std::string oldest_part_utc(const std::vector<CalibrationPicture>& pictures);

// Errors: std::runtime_error when the list or a picture is missing or a picture's hash differs.
std::vector<CalibrationPicture> read_calibration_pictures(const std::filesystem::path& folder);

}  // namespace station
