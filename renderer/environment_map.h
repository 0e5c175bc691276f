// Light from all around as a picture, far away: latitude by longitude, as photographed light probes come.
//
// Rows go from straight up (+z) to straight down, columns once round the z axis counter-clockwise from +x, seen from above;
// so a picture that is looked at from inside shows -y to the right of +x.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace renderer {

struct EnvironmentLight {
  cv::Mat3f radiance{};  // linear RGB, not negative
  double turn_rad = 0;   // of the surroundings round z, counter-clockwise seen from above
  bool visible = true;   // seen by camera rays
};

class EnvironmentMap {
 public:
  // Errors: std::runtime_error with one line for a picture that is empty, or has values below zero or that are not numbers.
  explicit EnvironmentMap(const EnvironmentLight& light);

  // Of a unit direction towards the surroundings, bilinear between the pixels' centres.
  Eigen::Array3f radiance(const Eigen::Vector3d& direction) const;
  // Unit direction, u in [0, 1)^2, in proportion to the light of each pixel and its neighbours.
  Eigen::Vector3d sample(const Eigen::Vector2f& u) const;
  // Density of `sample` per solid angle.
  double pdf(const Eigen::Vector3d& direction) const;
  // Sum of R, G and B over all directions, by solid angle (sr): what lights are chosen by.
  double power() const { return power_; }
  bool visible() const { return visible_; }

 private:
  Eigen::Vector2d place_of(const Eigen::Vector3d& direction) const;  // column, row; pixel centres at halves

  cv::Mat3f radiance_;
  double turn_rad_;
  bool visible_;
  double power_ = 0;
  std::vector<double> rows_;                  // cumulative shares, 0 first
  std::vector<std::vector<double>> columns_;  // of each row
};

}  // namespace renderer
