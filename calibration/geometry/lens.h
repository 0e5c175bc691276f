// A calibrated lens, and the removal of its distortion from pixel positions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace calibration {

// Model: OPENCV5 (k3 is 0 for fields of view too narrow to show it), in pixels, centre of the first pixel at (0, 0).
struct Lens {
  int width_px = 0, height_px = 0;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3
};

// A lens without distortion, centred on the picture.
Lens plain_lens(double focal_length_px, int width_px, int height_px);

// Pixel positions with the distortion removed (same intrinsic matrix, zero distortion).
std::vector<Eigen::Vector2d> undistort_points(const Lens& lens, const std::vector<Eigen::Vector2d>& pixels);

}  // namespace calibration
