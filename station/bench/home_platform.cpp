#include "station/bench/home_platform.h"

#include <optional>

#include "station/bench/platform_memory.h"
#include "station/bench/rig_devices.h"
#include "station/output/interrupt.h"

namespace station {

double home_platform(const HomeRequest& request) {
  watch_interrupts();
  const RigFile rig = read_rig(request.rig);
  const auto memory = request.stands_at_mark ? std::optional(platform_memory_file(rig)) : std::nullopt;
  const RigDevices devices = open_turntable(rig, request.asked);
  if (memory) forget_platform(*memory);  // not before: where there is no turntable, nobody has turned it
  devices.turntable->home();
  return devices.turntable->angle_rad();
}

}  // namespace station
