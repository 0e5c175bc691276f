// The input of the light calibration: spots of the Spectralon panel as seen, the pictures that show them, and the
// lamps as measured by tape and eye.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace calibration {

// The square of a pixel's distance to the image centre, in half diagonals.
inline double radius_squared(const Eigen::Vector2d& pixel, cv::Size size) {
  const double dx = pixel.x() - 0.5 * (size.width - 1), dy = pixel.y() - 0.5 * (size.height - 1);
  const double width = size.width, height = size.height;
  return 4.0 * (dx * dx + dy * dy) / (width * width + height * height);
}

template <typename T>
T vignetting_gain(double r2, const T* v) {
  return T(1) + r2 * (v[0] + r2 * v[1]);
}

// The lens's vignetting: gain = 1 + v0 r^2 + v1 r^4, r = distance to the image centre / half diagonal. The gain
// multiplies the radiance that reaches the sensor.
struct Vignetting {
  double v0 = 0.0, v1 = 0.0;
  double gain(double column, double row, cv::Size image_size) const;
};

struct PanelSpot {
  int light = 0;                                        // index of the place (0 front, 1 back)
  int picture = 0;                                      // index of the picture it was seen in
  Eigen::Vector3d point = Eigen::Vector3d::Zero();      // the spot's centre; world, mm
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();     // world, unit
  Eigen::Vector3d to_camera = Eigen::Vector3d::Zero();  // world, unit
  // Where the sensor saw the spot (not undistorted), for vignetting.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Vector3d radiance = Eigen::Vector3d::Zero();  // measured RGB, radiance unit, not flat-fielded
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();     // standard error of the radiance
};

struct LightPicture {
  std::string name = {};  // for messages
  // The lamp's output over its nominal one, as tags that stay where they are tell it; without it the output is taken as
  // nominal with a standard deviation of LightOptions::drift.
  std::optional<double> output = std::nullopt;
  double output_sigma = 0.001;
};

// A light as measured by tape and eye.
struct LightGuess {
  std::string name = "lamp";                           // for messages
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, mm
  double position_sigma_mm = 30;                       // per axis
  Eigen::Vector3d aim = Eigen::Vector3d::Zero();       // point at which the beam is aimed; world, mm
  double aim_sigma_rad = 0.1;
};

struct LightOptions {
  double albedo = 0.99;  // 8 degree / hemispherical reflectance of the panel
  cv::Size image_size{};
  double drift = 0.005;               // relative change of the lamp's output from picture to picture, without a reading
  double pose_sigma_rad = 0.002;      // standard error of the panel's direction in a picture
  double table_mm = 0;                // world z of the dark plane on which the bench stands
  bool published_droop_only = false;  // true: the panel's droop has the published shape, without the second term
};

}  // namespace calibration
