// The simulated turntable and camera as devices of this computer, in real time, for any program that speaks their
// protocols.
#pragma once

#include <functional>
#include <string>

#include "station/documents/faults_file.h"
#include "station/documents/rig_file.h"

namespace station {

struct SimulatedPorts {
  std::string turntable;  // "/dev/pts/4"; empty when the rig file simulates none on a wire
  std::string camera;     // "ptpip:127.0.0.1:41234:41234"; likewise
};

// Starts what the rig file names with "line": "simulated" and "port": "simulated", hands over the ports, and serves
// until `should_stop`. The pictures are of an empty bench in plain grey, with a mark that turns with the platform.
// Throws std::runtime_error when the rig file names nothing of that kind.
void simulate_hardware(const RigFile& rig, const Faults& faults,
                       const std::function<void(const SimulatedPorts&)>& started,
                       const std::function<bool()>& should_stop);

}  // namespace station
