// What pictures of the ring of tags on the platform tell of a bench on which nothing is calibrated yet: the focal
// length, roughly where the camera stands, and whether the platform turns as it says.
//
// A ring that is seen from above at a slant shows by its perspective from how far away it is seen, and by its size then
// the focal length. The lens counts as free of distortion and centred on the picture, and the ring's centre as lying on
// the platform's axis, so all of this is as good as a tape: enough to plan the calibration by.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "calibration/geometry/tags.h"

namespace calibration {

struct RingSighting {
  double reading_rad = 0;  // of the platform's angle
  TagObservation seen;
};

struct BenchSketch {
  double focal_length_px = 0;
  // The world frame with its origin on the platform's top instead of on the table, and the camera over +x.
  Eigen::Vector3d camera_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d aim_mm = Eigen::Vector3d::Zero();  // where the picture's middle passes the axis; x is 0
  double roll_rad = 0;                               // of the camera about its line of sight, clockwise
  double turned_per_reading = 1;                     // true angle over reading; negative: it turns the other way
  double first_tag_rad = 0;                          // from the camera to the ring's first tag, at reading 0
  double rms_px = 0;                                 // per axis, over all corners
};

// Errors: std::runtime_error for fewer than two readings, and for a picture with fewer than three of the ring's tags;
// the message says at which angle.
BenchSketch sketch_bench(const TagLayout& ring, cv::Size picture, const std::vector<RingSighting>& sightings);

}  // namespace calibration
