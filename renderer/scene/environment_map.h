// Light from all around as a picture, far away: latitude by longitude, as photographed light probes come.
//
// Rows go from straight up (+z) to straight down, columns once round the z axis counter-clockwise from +x, seen from
// above; so a picture that is looked at from inside shows -y to the right of +x.
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

// Errors: std::runtime_error with one line for a picture that is empty, or has values below zero or that are not
// numbers.
void check_radiances(const cv::Mat3f& picture);

class EnvironmentMap {
 public:
  // Errors: those of check_radiances.
  explicit EnvironmentMap(const EnvironmentLight& light);

  // The radiance from a unit direction towards the surroundings, bilinear between the pixels' centres.
  Eigen::Array3f radiance(const Eigen::Vector3d& direction) const;
  // A random unit direction, u in [0, 1)^2, in proportion to the light of each pixel and its neighbours.
  Eigen::Vector3d sample(const Eigen::Vector2f& u) const;
  // The density of `sample` per solid angle.
  double pdf(const Eigen::Vector3d& direction) const;
  // The sum of R, G and B over all directions, by solid angle (sr), by which one of several lights is chosen.
  double power() const { return power_; }
  bool visible() const { return visible_; }

 private:
  Eigen::Vector2d place_of(const Eigen::Vector3d& direction) const;  // column, row; pixel centres at halves

  cv::Mat3f radiance_;
  double turn_rad_;
  bool visible_;
  double power_ = 0;
  std::vector<double> rows_;                  // cumulative shares of the rows, 0 first
  std::vector<std::vector<double>> columns_;  // the same of each row's pixels
};

}  // namespace renderer
