#include "station/rig_devices.h"

#include <chrono>
#include <iostream>
#include <stdexcept>

#include "rig/console_operator.h"
#include "station/bench/bench_picture.h"

namespace station {

RigDevices open_rig(const RigFile& rig, const std::optional<Spool>& spool, bool unattended) {
  RigDevices devices;
  if (unattended && rig.operator_driver == "console")
    throw std::runtime_error("rig \"" + rig.name + "\" needs a person (operator: console); run without --unattended");
  // Exposures and moves of a simulated rig take no real time; its clock starts at the real date.
  const double now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  devices.clock = std::make_unique<rig::SimulatedClock>(now);
  devices.bench = std::make_unique<rig::SimulatedBench>(rig.simulation->truth, make_bench_picture(rig, spool));
  devices.camera = rig::make_simulated_camera(*devices.bench, *devices.clock);
  devices.turntable = rig::make_simulated_turntable(*devices.bench, *devices.clock);
  if (rig.operator_driver == "simulated")
    devices.person = rig::make_simulated_operator(*devices.bench);
  else
    devices.person = rig::make_console_operator(std::cin, std::cout);
  return devices;
}

}  // namespace station
