// Tries the devices of a rig before a session: connects, turns, takes test pictures, and says row by row what held.
#pragma once

#include <string>
#include <vector>

#include "rig/device_contract.h"
#include "station/documents/rig_file.h"

namespace station {

struct DeviceCheck {
  std::string device;  // "turntable (grbl on /dev/ttyUSB0)"
  std::vector<rig::ContractRow> rows;
};

// The platform must be free to turn. A device that cannot be connected has one row, which says why.
std::vector<DeviceCheck> check_rig(const RigFile& rig);

}  // namespace station
