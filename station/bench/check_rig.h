// Tries the devices of a rig before a session: connects, turns, takes test pictures, and says row by row what held.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rig/devices/device_contract.h"
#include "rig/people/asked_person.h"
#include "station/documents/calibration_file.h"
#include "station/documents/rig_file.h"

namespace station {

struct DeviceCheck {
  std::string device;  // "turntable (grbl on /dev/ttyUSB0)"
  std::vector<rig::ContractRow> rows;
};

// Tries both devices; the platform must be free to turn. A device that cannot be connected has one row, which says why.
// When there is a calibration and both devices are sound, a test picture is judged as well (check_picture.h). `asked`
// turns a platform that has no motor. Throws Interrupted when ctrl-C stopped it.
std::vector<DeviceCheck> check_rig(const RigFile& rig, const std::optional<RigCalibration>& calibration,
                                   rig::AskedPerson& asked);

}  // namespace station
