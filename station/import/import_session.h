// A session from pictures that were taken by hand: the same runner, checks and recorder, with a camera that hands out the
// listed files.
#pragma once

#include <filesystem>

#include "station/capture/run_state.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"
#include "station/import/import_file.h"
#include "station/progress.h"

namespace station {

struct ImportRequest {
  std::filesystem::path list;  // import file
  std::filesystem::path out;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Errors: std::runtime_error for the list, a file that cannot be read, files of several cameras, sizes, ISOs or
// apertures, a dark that has no view's exposure, and whatever the checks of a capture find.
RunState import_session(const ImportRequest& request);

// Poses, views, darks for the views of each exposure that a dark was taken of. `exposures_s`: of each listed picture.
Plan plan_of(const ImportFile& import, const std::vector<double>& exposures_s);

// Where camera and lamps stand by the rig file's tape, with a standard error of 10 mm; the lens from a lens file or, without
// distortion, from the focal length that the pictures' EXIF gives in 35 mm format, else from the rig's.
RigCalibration calibration_by_tape(const RigFile& rig, const ImportFile& import,
                                   const calibration::SensorPicture& first, const std::string& utc);

}  // namespace station
