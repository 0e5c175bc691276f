// What a test picture of the empty platform says before a session: exposure, focus, tags, and whether the bench still
// stands as it was calibrated.
#pragma once

#include <vector>

#include "rig/devices/device_contract.h"
#include "station/bench/rig_devices.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

// The width over which a tag's edge turns from dark to light (contrast / steepest step), the median of all edges, in
// pixels. A sharp lens gives about 2, a Gaussian blur of s pixels 2.5 s; 0 when no tag is seen.
double edge_width_px(const cv::Mat1f& grey, const calibration::TagObservation& seen);

// Homes the platform, takes the picture and judges it. The platform must be empty and the room light on; a simulated
// operator sees to it.
std::vector<rig::ContractRow> check_picture(const RigDevices& devices, const RigFile& rig,
                                            const RigCalibration& calibration);

}  // namespace station
