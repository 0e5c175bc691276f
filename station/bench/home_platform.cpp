#include "station/bench/home_platform.h"

#include "station/bench/platform_memory.h"
#include "station/bench/rig_devices.h"
#include "station/output/interrupt.h"

namespace station {

double home_platform(const HomeRequest& request) {
  watch_interrupts();
  const RigFile rig = read_rig(request.rig);
  if (request.stands_at_mark) forget_platform(platform_memory_file(rig));
  const RigDevices devices = open_turntable(rig, request.asked);
  devices.turntable->home();
  return devices.turntable->angle_rad();
}

}  // namespace station
