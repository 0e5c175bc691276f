// How fast a platform may turn so that a stop ends in time: within 5 degrees of where it was asked for.
#pragma once

namespace rig {

inline constexpr double kSureSpeedDegS = 10;  // for a controller that does not tell its acceleration

// The largest speed, in degrees per second, from which a platform that slows down by `acceleration_deg_s2` stands
// within 4 degrees when the stop takes 0.1 s to reach its motor; the fifth degree is for what nobody foresees.
double stoppable_speed_deg_s(double acceleration_deg_s2);

}  // namespace rig
