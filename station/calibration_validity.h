// Whether a rig calibration may be used: for this rig, lens, focus, camera body and aperture, young enough, and with every
// gate passed.
//
// Each function throws std::runtime_error with one line that says what was asked, what was found and what to do.
#pragma once

#include <string>

#include "calibration/sensor_file.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

// `utc_now` and the calibration's date as "2026-11-21T10:20:30.123Z". `accept_failed_gates`: the operator takes the
// responsibility for gates that failed; the rest is checked all the same.
void require_valid(const RigCalibration& calibration, const RigFile& rig, const std::string& utc_now,
                   bool accept_failed_gates);

// A picture of the camera that is at hand now.
void require_same_camera(const RigCalibration& calibration, const calibration::SensorPicture& picture,
                         const std::string& name);

// Days between two such dates; throws when one is not a date.
double days_between(const std::string& utc_from, const std::string& utc_to);

}  // namespace station
