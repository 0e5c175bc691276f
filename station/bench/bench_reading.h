// What the tags of one picture say of the bench: the platform's angle, and whether camera and table still stand as they
// were calibrated.
#pragma once

#include <optional>
#include <string>

#include "calibration/geometry/platform.h"
#include "calibration/geometry/still_tags.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

inline constexpr int kFewestRingTags = 2;  // that measure an angle

struct BenchReading {
  std::optional<calibration::AngleFit> angle;  // from kFewestRingTags or more tags of the ring
  std::optional<calibration::Shift> shift;     // of the table's tags since the calibration
};

BenchReading read_bench(const RigCalibration& calibration, const RigFile& rig, const calibration::TagObservation& seen);

// The largest shift of the table's tags that is still measurement error: 0.1 mm where they lie, and 0.3 px by which the
// corners of small tags scatter in the lamp's light.
double still_limit_px(const RigCalibration& calibration);

// A line for people when the platform stands more than half a degree from what the turntable read; `picture` is the
// picture's name in that line.
std::optional<std::string> slip_problem(const RigCalibration& calibration, const BenchReading& found,
                                        double reading_rad, const std::string& picture);

// Throws BenchFault, naming the picture, when camera or table have moved since the calibration, or the platform
// stands more than half a degree from what the turntable read.
void require_calibrated_bench(const RigCalibration& calibration, const BenchReading& found, double reading_rad,
                              const std::string& picture);

}  // namespace station
