// A session from pictures that were taken by hand: the same runner, checks and recorder, with a camera that hands out
// the listed files.
#pragma once

#include <filesystem>

#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"
#include "station/session/capture_request.h"
#include "station/session/import_file.h"
#include "station/session/record/run_state.h"

namespace station {

// `list`: the import file, which names what the session is made of in place of the request's `new_session`.
// Errors: std::runtime_error for the list, a file that cannot be read, files of several cameras, sizes, ISOs or
// apertures, a dark that has no view's exposure, and whatever the checks of a capture find.
RunState import_session(const std::filesystem::path& list, const CaptureRequest& request);

// The plan of the listed pictures: poses, views, and darks for all views with the exposure of a listed dark.
// `exposures_s`: one of each listed picture, in the list's order.
Plan plan_of(const ImportFile& import, const std::vector<double>& exposures_s);

// A calibration by the rig file's tape measures of camera and lamps, with a standard error of 10 mm. The lens is that
// of a lens file or, without distortion, has the focal length that the pictures' EXIF gives in 35 mm format, else the
// rig's.
RigCalibration calibration_by_tape(const RigFile& rig, const ImportFile& import,
                                   const calibration::SensorPicture& first, const std::string& utc);

}  // namespace station
