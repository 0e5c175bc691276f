// The light calibration: position, beam and intensity of a near point light, the Spectralon panel's droop and the
// lens's vignetting, from pictures of the panel under one lamp at one or several places.
//
// Radiance of a spot: output(picture) * gain(pixel) * albedo / pi * panel * I_c * cos^mu(theta_l) * cos(theta_i) /
// d^2, with d = |light - spot|, theta_i the angle of incidence on the panel and theta_l the angle from the lamp's
// axis. panel = 1 + droop[0] * s (spectralon.h) + droop[1] * 2 (cos(theta_i) - cos(8 degrees)): the published shape,
// and a term by which a panel may differ from it. The table around, however black, sends light to panels that lean, so
// its albedo is fitted, too (left out, an albedo of 3 % put lamps 3 mm off). The lamp, its intensity and beam are the
// same at every place; each place has its own position and axis. Source of the beam: Queau et al. 2018, doi
// 10.1007/s10851-017-0761-1.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/lens.h"
#include "calibration/light/light_measurements.h"
#include "calibration/sensor/gate.h"

namespace calibration {

// One picture as the fit to all the others predicts it (with its own reading of the lamp, where there is one).
struct HeldOutPicture {
  std::string name;
  int light = 0;
  double output = 1.0;         // the lamp's output in this picture, as fitted
  double spot_error = 0.0;     // rms over spots and channels of predicted / measured - 1
  double picture_error = 0.0;  // mean over spots and channels of predicted / measured - 1
};

struct LightFit {
  std::vector<Eigen::Vector3d> positions;  // world, mm, one per place
  std::vector<Eigen::Vector3d> beam_axes;  // unit vectors from the lamp, world, one per place
  double beam_exponent = 0.0;
  Eigen::Vector3d intensity = Eigen::Vector3d::Zero();  // RGB, radiance unit x mm^2, along the axis
  Eigen::Vector2d droop = Eigen::Vector2d::Zero();      // of the published shape, and of incidence alone
  double table_albedo = 0.0;
  Vignetting vignetting;
  // These covariances come from leaving out one picture after the other (jackknife) and from another shape of the
  // panel's droop. The covariance of least squares knows of noise only and was a twentieth of the error in simulations.
  std::vector<Eigen::Matrix3d> position_covariances;
  Eigen::Matrix3d intensity_covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix2d vignetting_covariance = Eigen::Matrix2d::Zero();  // v0 v1
  double beam_exponent_sigma = 0.0;
  Eigen::Vector2d droop_sigma = Eigen::Vector2d::Zero();
  // Relative standard error of the irradiance on a surface that faces the light where it is aimed, one per place.
  std::vector<double> aim_irradiance_sigma;
  double relative_rms = 0.0;  // rms of (model - measured) / measured, over the spots used
  int spots_used = 0;         // spots lit (by the guess) more than 5 degrees from grazing and brighter than 3 sigma
  std::vector<HeldOutPicture> held_out;
  std::vector<Gate> gates;
  bool converged = false;
};

// The root mean square of the picture errors of one light's held-out pictures.
double held_out_error(const LightFit& fit, int light);

// The irradiance (RGB, radiance unit) on a surface at `point` (world, mm) that faces the light.
Eigen::Vector3d facing_irradiance(const LightFit& fit, std::size_t light, const Eigen::Vector3d& point);

// The radiance of the panel over that of a Lambertian surface with its reflectance; directions are unit vectors.
double panel_factor(const Eigen::Vector2d& droop, const Eigen::Vector3d& normal, const Eigen::Vector3d& to_light,
                    const Eigen::Vector3d& to_camera);

// Fits the lights to the spots. `pictures` are those whose indices spots name; the list may be empty when no
// reading is known. Throws std::runtime_error, naming what is missing, when the pictures cannot determine a light, a
// picture is dark, or a measurement is not a finite number. Failed gates are for the caller to act on.
LightFit fit_light(const std::vector<PanelSpot>& spots, const std::vector<LightGuess>& guesses,
                   const LightOptions& options, const std::vector<LightPicture>& pictures = {});

}  // namespace calibration
