// One degree in radians: 30 * kDegree is an angle in radians, angle_rad / kDegree the same angle in degrees. Degrees
// stand in files, in texts for people and in constants; everything else is in radians.
#pragma once

#include <numbers>

namespace station {

inline constexpr double kDegree = std::numbers::pi / 180;

}  // namespace station
