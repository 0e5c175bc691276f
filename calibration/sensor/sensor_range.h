// Parts of a sensor's range, from its black level (0) to its white level (1).
#pragma once

#include "calibration/sensor/sensor_file.h"

namespace calibration {

inline constexpr double kSaturated = 0.98;  // above it a raw value is saturated
inline constexpr double kBrightest = 0.92;  // above it single pixels saturate by noise

// The raw value at a part of the range.
inline double dn_at(const SensorPicture& picture, double part) {
  return picture.black_level_dn + part * (picture.white_level_dn - picture.black_level_dn);
}

}  // namespace calibration
