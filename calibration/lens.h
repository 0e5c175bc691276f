// Lens calibration from views of a tag board: pictures' corners in, intrinsics with residuals and covariance out.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "calibration/tags.h"

namespace calibration {

// OpenCV5 lens: pixels, centre of the first pixel at (0, 0).
struct Lens {
  int width_px = 0, height_px = 0;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, 5> distortion{};  // k1 k2 p1 p2 k3
};

struct LensFit {
  Lens lens;
  double rms_px = 0.0;         // per axis, over the corners used
  Eigen::MatrixXd covariance;  // 9 x 9: fx fy cx cy k1 k2 p1 p2 k3 (pixels where they have units), for the noise that
                               // the residuals show
  std::vector<double> view_rms_px;  // one per view; 0 for a view with fewer than two tags, which is left out
  // How far the board's middle stands out of the plane of its edges, along its x and its y, mm, with standard errors.
  Eigen::Vector2d board_warp_mm = Eigen::Vector2d::Zero(), board_warp_sigma_mm = Eigen::Vector2d::Zero();
  int corners_used = 0;
  int corners_rejected = 0;  // further than 5 sigma from the fit
  bool converged = false;
};

// Board views -> lens. `focal_guess_px` from EXIF or the rig file, good to a factor of two. Throws std::runtime_error
// when the views cannot determine a lens (too few, all alike), saying what is missing.
LensFit fit_lens(const std::vector<TagObservation>& views, const TagLayout& board, cv::Size image_size,
                 double focal_guess_px);

// Pixel positions with the distortion removed (same intrinsic matrix, zero distortion).
std::vector<Eigen::Vector2d> undistort_points(const Lens& lens, const std::vector<Eigen::Vector2d>& pixels);

}  // namespace calibration
