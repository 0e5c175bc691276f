// The synthetic truth of a whole bench for the calibration tests: a camera above a platform whose tagged ring turns,
// tags on the table, a holder on the platform, and their corners with known noise.
#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "calibration/geometry/platform.h"
#include "calibration/geometry/pose.h"

namespace calibration::synthetic {

struct Bench {
  Lens lens;
  PlatformTargets targets;
  TagLayout holder;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d world_from_ring = Eigen::Isometry3d::Identity();   // at platform angle 0
  Eigen::Isometry3d world_from_table = Eigen::Isometry3d::Identity();  // the tags' sheet; its table leans a little
  Eigen::Isometry3d platform_from_holder = Eigen::Isometry3d::Identity();
  double scale = 1.004;  // true angle / reading
};

// A bench whose camera is 600 mm from the platform's centre, 30 degrees up. The axis leans by 0.4 degrees against the
// table's normal, which matters only to the definition of the world frame; the ring is glued on 1.5 mm off the axis and
// leans by 0.3 degrees.
Bench bench(const Lens& lens);

// A lens of 6000 x 4000 px, f about 8400 px: a 50 mm lens on a full-frame sensor of 24 megapixels.
Lens full_size_lens();

// Views of the empty platform at these readings; corners have noise of `sigma_px`.
std::vector<PlatformPicture> turning_views(const Bench& bench, const std::vector<double>& readings_rad, double sigma_px,
                                           std::mt19937& random);
// Readings from -60 to 60 degrees in steps of 15.
std::vector<double> usual_readings_rad();

// The tags seen with the holder on the platform, which hides the tags behind it; the platform is at this true angle.
TagObservation holder_view(const Bench& bench, double angle_rad, double sigma_px, std::mt19937& random);

// The errors of the fitted axis in the true world frame: tilts about x and y (rad), and position in x and y (mm) where
// it meets the table.
Eigen::Vector4d axis_error(const PlatformFit& found, const Bench& bench);

}  // namespace calibration::synthetic
