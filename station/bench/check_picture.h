// What a test picture of the empty platform says before a session: exposure, focus, tags, and whether the bench still
// stands as it was calibrated.
#pragma once

#include <vector>

#include "rig/devices/device_contract.h"
#include "station/bench/rig_devices.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

// Homes the platform, takes the picture and judges it. The platform must be empty and the room light on; a simulated
// operator sees to it.
std::vector<rig::ContractRow> check_picture(const RigDevices& devices, const RigFile& rig,
                                            const RigCalibration& calibration);

}  // namespace station
