#include "rig/turntables/stopping.h"

#include <cmath>

namespace rig {

double stoppable_speed_deg_s(double acceleration_deg_s2) {
  constexpr double kWayDeg = 4, kLatencyS = 0.1;
  // v^2 / 2a + latency v = way, solved for v.
  return acceleration_deg_s2 * (std::sqrt(kLatencyS * kLatencyS + 2 * kWayDeg / acceleration_deg_s2) - kLatencyS);
}

}  // namespace rig
