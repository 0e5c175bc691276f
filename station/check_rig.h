// Tries the devices of a rig before a session: connects, turns, takes test pictures, and says row by row what held.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig/device_contract.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

struct DeviceCheck {
  std::string device;  // "turntable (grbl on /dev/ttyUSB0)"
  std::vector<rig::ContractRow> rows;
};

// The platform must be free to turn. A device that cannot be connected has one row, which says why. With a calibration and
// both devices sound, a test picture as well (check_picture.h).
std::vector<DeviceCheck> check_rig(const RigFile& rig, const std::optional<RigCalibration>& calibration);

}  // namespace station
