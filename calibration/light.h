// Position, beam and intensity of a near point light, the Spectralon panel's droop and the lens's vignetting, from
// pictures of the panel under one lamp at one or several places.
//
// Radiance of a patch: output(picture) * gain(pixel) * albedo / pi * panel * I_c * cos^mu(theta_l) * cos(theta_i) / d^2,
// d = |light - patch|, theta_i at the panel, theta_l from the lamp's axis; panel = 1 + droop[0] * s (spectralon.h) +
// droop[1] * 2 (cos(theta_i) - cos(8 degrees)): the published shape, and what a panel may differ from it by. The table
// around, however black, sends light to panels that lean: its albedo is fitted, too (3 % of it put lamps 3 mm off). The
// lamp, its intensity and beam are the same at every place; every place has its own position and axis. Source of the
// beam: Queau et al. 2018, doi 10.1007/s10851-017-0761-1.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/gate.h"
#include "calibration/lens.h"

namespace calibration {

// gain = 1 + v0 r^2 + v1 r^4, r = distance to the image centre / half diagonal; multiplies the radiance that reaches
// the sensor.
struct Vignetting {
  double v0 = 0.0, v1 = 0.0;
  double gain(double column, double row, cv::Size image_size) const;
};

struct LightPatch {
  int light = 0;                                        // index of the place (0 front, 1 back)
  int picture = 0;                                      // index of the picture it was seen in
  Eigen::Vector3d point = Eigen::Vector3d::Zero();      // world, mm, at the patch centre
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();     // world, unit
  Eigen::Vector3d to_camera = Eigen::Vector3d::Zero();  // world, unit
  Eigen::Vector2d pixel =
      Eigen::Vector2d::Zero();  // where it was seen (for vignetting), on the sensor: not undistorted
  Eigen::Vector3d radiance = Eigen::Vector3d::Zero();  // measured RGB, radiance unit, not flat-fielded
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();     // its standard error
};

struct LightPicture {
  std::string name = {};  // for messages
  // Reading of a reference patch that stays where it is: the lamp's output over its nominal one. None: unknown to
  // LightOptions::drift.
  std::optional<double> output = std::nullopt;
  double output_sigma = 0.001;
};

// A light as measured by tape and eye.
struct LightGuess {
  std::string name = "lamp";                           // for messages
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, mm
  double position_sigma_mm = 30;                       // per axis
  Eigen::Vector3d aim = Eigen::Vector3d::Zero();       // world, mm: what its beam is pointed at
  double aim_sigma_rad = 0.1;
};

struct LightOptions {
  double albedo = 0.99;  // 8 degree / hemispherical reflectance of the panel
  cv::Size image_size{};
  double drift = 0.005;               // of the lamp's output from picture to picture, without a reading
  double pose_sigma_rad = 0.002;      // of the panel's direction in a picture
  double table_mm = 0;                // world z of the dark plane that the bench stands on
  bool published_droop_only = false;  // the panel droops as the published one does: no second term
};

// One picture as the fit of all the others predicts it (with its own reading of the lamp, where there is one).
struct HeldOutPicture {
  std::string name;
  int light = 0;
  double output = 1.0;         // of the lamp in this picture, as fitted
  double patch_error = 0.0;    // rms over patches and channels of predicted / measured - 1
  double picture_error = 0.0;  // mean of the same
};

struct LightFit {
  std::vector<Eigen::Vector3d> positions;  // world, mm, one per place
  std::vector<Eigen::Vector3d> beam_axes;  // world, unit, from the lamp
  double beam_exponent = 0.0;
  Eigen::Vector3d intensity = Eigen::Vector3d::Zero();  // RGB, radiance unit x mm^2, along the axis
  Eigen::Vector2d droop = Eigen::Vector2d::Zero();      // of the published shape, and with incidence alone
  double table_albedo = 0.0;
  Vignetting vignetting;
  // What leaving out one picture after the other changes (jackknife), and what another shape of the panel's droop
  // changes. Least squares' own covariance knows of noise only and was a twentieth of the error in simulations.
  std::vector<Eigen::Matrix3d> position_covariances;
  Eigen::Matrix3d intensity_covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix2d vignetting_covariance = Eigen::Matrix2d::Zero();  // v0 v1
  double beam_exponent_sigma = 0.0;
  Eigen::Vector2d droop_sigma = Eigen::Vector2d::Zero();
  std::vector<double> aim_irradiance_sigma;  // relative, facing the light where it is aimed at, one per place
  double relative_rms = 0.0;                 // of (model - measured) / measured, over the patches used
  // Those that faced their light by more than 5 degrees (as guessed) and were brighter than 3 sigma.
  int patches_used = 0;
  std::vector<HeldOutPicture> held_out;
  std::vector<Gate> gates;
  bool converged = false;
};

// Root mean square of the picture errors of one light's held-out pictures.
double held_out_error(const LightFit& fit, int light);

// Irradiance on a surface at `point` (world, mm) that faces the light (RGB, radiance unit).
Eigen::Vector3d facing_irradiance(const LightFit& fit, std::size_t light, const Eigen::Vector3d& point);

// What the panel reflects over a Lambertian surface of its reflectance; directions are unit vectors.
double panel_factor(const Eigen::Vector2d& droop, const Eigen::Vector3d& normal, const Eigen::Vector3d& to_light,
                    const Eigen::Vector3d& to_camera);

// `pictures` are those that patches name, and may be empty when no reading is known. Throws std::runtime_error, naming
// what is missing, when the pictures cannot determine a light, a picture is dark, or a measurement is not a finite
// number. Failed gates are for the caller to act on.
LightFit fit_light(const std::vector<LightPatch>& patches, const std::vector<LightGuess>& guesses,
                   const LightOptions& options, const std::vector<LightPicture>& pictures = {});

}  // namespace calibration
