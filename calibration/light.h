// Position and intensity of a near point light, and the lens's vignetting, from pictures of a Spectralon panel.
//
// Model of a patch: radiance_c = gain(pixel) * albedo / pi * I_c * cos(theta) / d^2, d = |light - patch|: the panel
// is taken for Lambertian. A real one is about 10 % brighter at 0-20 than at 40-60 degrees of incidence (a published
// model, doi 10.1109/TGRS.2024.3361392), which would put a light 30 mm wrong; the simulated panel is Lambertian.
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
  int light = 0;                                     // index of the light (0 front, 1 back)
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   // world, mm, at the patch centre
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // world, unit
  Eigen::Vector2d pixel =
      Eigen::Vector2d::Zero();  // where it was seen (for vignetting), on the sensor: not undistorted
  Eigen::Vector3d radiance = Eigen::Vector3d::Zero();  // measured RGB, radiance unit, not flat-fielded
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();     // its standard error
};

struct LightFit {
  std::vector<Eigen::Vector3d> positions;  // world, mm, one per light
  // For the scatter that the residuals show, of noise only: what the panel and the poses are wrong by is not in it,
  // and was twenty times as large in simulations. Not the accuracy.
  std::vector<Eigen::Matrix3d> position_covariances;
  Eigen::Vector3d intensity = Eigen::Vector3d::Zero();  // RGB, radiance unit x mm^2, the same lamp at every position
  Eigen::Matrix3d intensity_covariance = Eigen::Matrix3d::Zero();
  Vignetting vignetting;
  Eigen::Matrix2d vignetting_covariance = Eigen::Matrix2d::Zero();  // v0 v1
  double relative_rms = 0.0;  // of (model - measured) / measured, over the patches used
  int patches_used =
      0;  // those that faced their light by more than 5 degrees (as guessed) and were brighter than 3 sigma
  bool converged = false;
};

// `guesses`: tape-measured positions, one per light (world, mm). Throws std::runtime_error when a light was not seen
// on at least 6 patches of 2 or more directions that face it, or a measurement is not a finite number.
LightFit fit_light(const std::vector<LightPatch>& patches, const std::vector<Eigen::Vector3d>& guesses, double albedo,
                   cv::Size image_size);

}  // namespace calibration
