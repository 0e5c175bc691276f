// Whether a rig calibration may be used: it must be of this rig, lens, focus, camera body and aperture, young enough,
// and have passed every gate.
//
// Each function throws std::runtime_error with one line that says what was asked, what was found and what to do.
#pragma once

#include <string>

#include "calibration/sensor/sensor_file.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

// Checks everything that needs no picture. `utc_now` is written as "2026-11-21T10:20:30.123Z". With
// `accept_failed_gates` the operator takes the responsibility for gates that failed; the rest is checked all the same.
void require_valid(const RigCalibration& calibration, const RigFile& rig, const std::string& utc_now,
                   bool accept_failed_gates);

// Checks that the camera at hand is the calibrated one, by a picture that it has just taken; `name` is the picture's.
void require_same_camera(const RigCalibration& calibration, const calibration::SensorPicture& picture,
                         const std::string& name);

// The days between two dates that are written like `utc_now`; throws when one is not a date.
double days_between(const std::string& utc_from, const std::string& utc_to);

}  // namespace station
