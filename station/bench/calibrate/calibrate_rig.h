// The guided calibration of a rig: takes the pictures, solves, writes <out>/calibration.json.
#pragma once

#include <filesystem>
#include <string>

#include "rig/people/asked_person.h"
#include "station/bench/calibrate/solve_calibration.h"
#include "station/output/progress.h"

namespace station {

struct CalibrateRequest {
  std::filesystem::path rig, out;
  // "camera", "platform", "light" or "response": these pictures are taken again; empty: what is missing is taken.
  std::string only;
  bool solve_only = false;            // pictures are there already
  std::filesystem::path live;         // JPEG of what the camera sees while a target is put down; empty: none
  rig::AskedPerson* asked = nullptr;  // none: refused when the rig needs a person
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Errors: std::runtime_error of the devices, of the disk, and of pictures that cannot determine a part. What was taken
// stays, and the next call goes on from there.
RigCalibration calibrate_rig(const CalibrateRequest& request);

}  // namespace station
