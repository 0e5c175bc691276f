// Position and intensity of a near point light, and the lens's vignetting, from pictures of a Spectralon panel.
//
// Model of a patch: radiance_c = gain(pixel) * albedo / pi * I_c * cos(theta) / d^2, d = |light - patch|.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

#include "calibration/lens.h"

namespace calibration {

// gain = 1 + v0 r^2 + v1 r^4, r = distance to the image centre / half diagonal; multiplies the radiance that reaches
// the sensor.
struct Vignetting {
  double v0 = 0.0, v1 = 0.0;
  double gain(double column, double row, cv::Size image_size) const;
};

struct LightPatch {
  int light = 0;                  // index of the light (0 front, 1 back)
  Eigen::Vector3d point, normal;  // world, mm / unit, at the patch centre
  Eigen::Vector2d pixel;          // where it was seen (for vignetting)
  Eigen::Vector3d radiance;       // measured RGB, radiance unit, not flat-fielded
  Eigen::Vector3d sigma;          // its standard error
};

struct LightFit {
  std::vector<Eigen::Vector3d> positions;  // world, mm, one per light
  std::vector<Eigen::Matrix3d> position_covariances;
  Eigen::Vector3d intensity = Eigen::Vector3d::Zero();  // RGB, radiance unit x mm^2, the same lamp at every position
  Eigen::Matrix3d intensity_covariance = Eigen::Matrix3d::Zero();
  Vignetting vignetting;
  double relative_rms = 0.0;  // of (model - measured) / measured
  bool converged = false;
};

// `guesses`: tape-measured positions, one per light (world, mm).
LightFit fit_light(const std::vector<LightPatch>& patches, const std::vector<Eigen::Vector3d>& guesses, double albedo,
                   cv::Size image_size);

}  // namespace calibration
