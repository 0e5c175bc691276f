#include "renderer/scene/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "renderer/scattering/lobes.h"

namespace renderer {
namespace {

// The solid angle of each pixel of a row.
double pixel_solid_angle(const cv::Mat3f& picture, int row) {
  const double top = std::numbers::pi * row / picture.rows, bottom = std::numbers::pi * (row + 1) / picture.rows;
  return 2 * std::numbers::pi / picture.cols * (std::cos(top) - std::cos(bottom));
}

// The brightness of pixels for sampling: a pixel's light is seen as far as its neighbours' centres.
cv::Mat1f with_neighbours(const cv::Mat3f& picture) {
  cv::Mat3f wide;
  cv::copyMakeBorder(picture, wide, 0, 0, 1, 1, cv::BORDER_WRAP);
  cv::copyMakeBorder(wide, wide, 1, 1, 0, 0, cv::BORDER_REPLICATE);
  cv::Mat1f sums;
  cv::transform(wide, sums, cv::Matx13f(1, 1, 1));
  cv::blur(sums, sums, {3, 3});
  return sums({1, 1, picture.cols, picture.rows}).clone();
}

std::vector<double> cumulative(const std::vector<double>& weights) {
  std::vector<double> shares{0};
  for (const double weight : weights) shares.push_back(shares.back() + weight);
  const double total = shares.back();
  const auto count = static_cast<double>(weights.size());
  for (std::size_t i = 0; i < shares.size(); ++i)
    shares[i] = total > 0 ? shares[i] / total : static_cast<double>(i) / count;
  return shares;
}

struct Draw {
  std::size_t index;
  double within;  // [0, 1)
};

Draw draw(const std::vector<double>& shares, double u) {
  const auto above = std::upper_bound(shares.begin() + 1, shares.end() - 1, u);
  const auto index = static_cast<std::size_t>(above - shares.begin()) - 1;
  const double width = shares[index + 1] - shares[index];
  return {index, width > 0 ? std::clamp((u - shares[index]) / width, 0.0, 1.0) : 0.5};
}

}  // namespace

void check_radiances(const cv::Mat3f& picture) {
  if (picture.empty()) throw std::runtime_error("the picture of the surroundings is empty; give one of radiances");
  for (const cv::Vec3f& pixel : picture)
    for (int c = 0; c < 3; ++c)
      if (!(pixel[c] >= 0 && std::isfinite(pixel[c])))
        throw std::runtime_error("the picture of the surroundings has the radiance " + std::to_string(pixel[c]) +
                                 "; none can be below zero or without end");
}

EnvironmentMap::EnvironmentMap(const EnvironmentLight& light)
    : radiance_(light.radiance.clone()), turn_rad_(light.turn_rad), visible_(light.visible) {
  check_radiances(radiance_);
  const cv::Mat1f weights = with_neighbours(radiance_);
  std::vector<double> of_rows;
  for (int row = 0; row < radiance_.rows; ++row) {
    const std::vector<double> of_row(weights.ptr<float>(row), weights.ptr<float>(row) + weights.cols);
    columns_.push_back(cumulative(of_row));
    double sum = 0, power = 0;
    for (const double weight : of_row) sum += weight;
    for (int column = 0; column < radiance_.cols; ++column) {
      const cv::Vec3f& pixel = radiance_(row, column);
      power += pixel[0] + pixel[1] + pixel[2];
    }
    of_rows.push_back(sum * pixel_solid_angle(radiance_, row));
    power_ += power * pixel_solid_angle(radiance_, row);
  }
  rows_ = cumulative(of_rows);
}

Eigen::Vector2d EnvironmentMap::place_of(const Eigen::Vector3d& direction) const {
  // Single precision finds it to a thousandth of a pixel of a large picture, in half the time.
  const Eigen::Vector3f d = direction.cast<float>();
  const double azimuth = static_cast<double>(std::atan2(d.y(), d.x())) - turn_rad_,
               polar = static_cast<double>(std::atan2(d.head<2>().norm(), d.z()));
  const double turns = azimuth / (2 * std::numbers::pi);
  return {(turns - std::floor(turns)) * radiance_.cols, polar / std::numbers::pi * radiance_.rows};
}

Eigen::Array3f EnvironmentMap::radiance(const Eigen::Vector3d& direction) const {
  const Eigen::Vector2d at = place_of(direction) - Eigen::Vector2d(0.5, 0.5);
  const auto column = static_cast<int>(std::floor(at.x())), row = static_cast<int>(std::floor(at.y()));
  const auto u = static_cast<float>(at.x() - column), v = static_cast<float>(at.y() - row);
  const auto pixel = [&](int right, int down) {
    const cv::Vec3f& p =
        radiance_(std::clamp(row + down, 0, radiance_.rows - 1), (column + right + radiance_.cols) % radiance_.cols);
    return Eigen::Array3f(p[0], p[1], p[2]);
  };
  return (1 - v) * ((1 - u) * pixel(0, 0) + u * pixel(1, 0)) + v * ((1 - u) * pixel(0, 1) + u * pixel(1, 1));
}

Eigen::Vector3d EnvironmentMap::sample(const Eigen::Vector2f& u) const {
  const Draw row = draw(rows_, static_cast<double>(u.y()));
  const Draw column = draw(columns_[row.index], static_cast<double>(u.x()));
  // Uniform by solid angle within the pixel, because the cosine is uniform.
  const double top = std::cos(std::numbers::pi * static_cast<double>(row.index) / radiance_.rows),
               bottom = std::cos(std::numbers::pi * static_cast<double>(row.index + 1) / radiance_.rows);
  const double cosine = top + (bottom - top) * row.within, sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double azimuth =
      2 * std::numbers::pi * (static_cast<double>(column.index) + column.within) / radiance_.cols + turn_rad_;
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

double EnvironmentMap::pdf(const Eigen::Vector3d& direction) const {
  const Eigen::Vector2d at = place_of(direction);
  const auto row = std::min(static_cast<std::size_t>(at.y()), rows_.size() - 2);
  const std::vector<double>& columns = columns_[row];
  const auto column = std::min(static_cast<std::size_t>(at.x()), columns.size() - 2);
  return (rows_[row + 1] - rows_[row]) * (columns[column + 1] - columns[column]) /
         pixel_solid_angle(radiance_, static_cast<int>(row));
}

}  // namespace renderer
