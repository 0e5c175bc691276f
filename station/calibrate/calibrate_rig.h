// The guided calibration of a rig: takes the pictures, solves, writes <out>/calibration.json.
#pragma once

#include <filesystem>
#include <string>

#include "station/calibrate/solve_calibration.h"
#include "station/progress.h"

namespace station {

struct CalibrateRequest {
  std::filesystem::path rig, out;
  std::string
      only;  // "camera", "platform", "light", "response": these pictures are taken again; empty = what is missing
  bool solve_only = false;  // pictures are there already
  ProgressStyle progress_style = ProgressStyle::automatic;
};

RigCalibration calibrate_rig(const CalibrateRequest& request);

}  // namespace station
