// Synthetic truth of a whole bench for the calibration tests: a camera above a platform whose tagged ring turns, tags on
// the table, a holder on the platform, and their corners with known noise.
#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "calibration/platform.h"
#include "calibration/pose.h"

namespace calibration::synthetic {

struct Bench {
  Lens lens;
  PlatformTargets targets;
  TagLayout holder;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d world_from_ring = Eigen::Isometry3d::Identity();   // at angle 0
  Eigen::Isometry3d world_from_table = Eigen::Isometry3d::Identity();  // of the sheet; its table leans a little
  Eigen::Isometry3d platform_from_holder = Eigen::Isometry3d::Identity();
  double scale = 1.004;  // true angle / reading
};

// A camera 600 mm from the platform's centre, 30 degrees up. The axis leans by 0.4 degrees against the table's normal,
// which only the definition of the world frame sees; the ring is glued on 1.5 mm off the axis and leans by 0.3 degrees.
Bench bench(const Lens& lens);

// 6000 x 4000 px, f about 8400 px: a 50 mm lens on a full-frame sensor of 24 megapixels.
Lens full_size_lens();

// The empty platform at these readings.
std::vector<PlatformView> turning_views(const Bench& bench, const std::vector<double>& readings_rad, double sigma_px,
                                        std::mt19937& random);
// -60 to 60 degrees in steps of 15.
std::vector<double> usual_readings_rad();

// The holder stands on the platform and hides the tags behind it; the platform is at this true angle.
TagObservation holder_view(const Bench& bench, double angle_rad, double sigma_px, std::mt19937& random);

// Tilts about x and y (rad) and position in x and y (mm) of the fitted axis where it meets the table, in the true
// world frame.
Eigen::Vector4d axis_error(const PlatformFit& found, const Bench& bench);

}  // namespace calibration::synthetic
