// The stands that hold the calibration targets on the platform: each leans a plate back by its own angle, so that the
// platform can show it to camera and lamps from all sides, and a person only exchanges what stands there.
//
// A stand has a ledge, on which the plate's lower edge stands, and behind it two cheeks, against which the plate leans.
// The ledge lies in front of the stand's middle so far that the middle of the Spectralon panel, which is what all
// stands are drawn for, comes over the platform's axis.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "calibration/sensor/degree.h"

namespace calibration {

// From the vertical. By 100 simulated calibrations (tests/calibration/light/light_accuracy_test.cpp) four stands, of
// which two serve each lamp, put lamps 1.9 and 1.5 mm off (rms); three (15, 45, 75 degrees) 2.1 and 1.9, with single
// errors above 5 mm.
inline constexpr std::array<double, 4> kStandLeans_rad{15 * kDegree, 35 * kDegree, 55 * kDegree, 75 * kDegree};
inline constexpr double kLedgeHeight_mm = 6;  // of the plate's lower edge above the platform

// Where the plate's lower edge stands: mm in front of the stand's middle.
double ledge_mm(double lean_rad, double panel_mm);

// platform_from_plate (mm; platform frame at angle 0 = world, top of the platform at `platform_mm`) of a plate
// `plate_mm` high on the stand that leans by `lean_rad`, in the platform's middle and facing +x. The plate's frame:
// origin in its middle, +x right, +y up, +z out of its face.
Eigen::Isometry3d on_stand(double lean_rad, double plate_mm, double panel_mm, double platform_mm);

// What stands on the platform, in the world, when the platform is turned by `angle_rad`.
Eigen::Isometry3d turned(double angle_rad, const Eigen::Isometry3d& platform_from_object);

}  // namespace calibration
