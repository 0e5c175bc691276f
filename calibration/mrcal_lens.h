// Board views -> lens by mrcal 2.2: the bundle over lens, board poses and board warp, and its uncertainty. The only place
// that knows mrcal.
//
// Lattice points and poses in mm, pixels with the centre of the first pixel at (0, 0), camera axes as in OpenCV.
// mrcal's own RMS is not used: it counts masked corners and regularisation terms as if they were measurements.
// Whatever the library prints on standard error is caught. Source: mrcal.secretsauce.net, mrcal.h 2.2.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calibration/lattice.h"

namespace calibration {

enum class LensModel { opencv4, opencv5, opencv8 };

// fx fy cx cy k1 k2 p1 p2 (k3 (k4 k5 k6)), OpenCV's order.
struct ModelledLens {
  LensModel model = LensModel::opencv5;
  cv::Size image_size;
  std::vector<double> intrinsics;
};

int number_of_intrinsics(LensModel model);

// The same lens in another model: further coefficients are 0, surplus ones are dropped.
ModelledLens as(LensModel model, ModelledLens lens);

Eigen::Vector2d project_with(const ModelledLens& lens, const Eigen::Vector3d& point_in_camera);
Eigen::Vector3d ray_of(const ModelledLens& lens, const Eigen::Vector2d& pixel);  // unit

struct BundleView {
  LatticeView corners;
  std::vector<bool> used;  // one per corner
  Eigen::Isometry3d camera_from_lattice = Eigen::Isometry3d::Identity();
};

// A seed on input, the solution on output.
struct LensBundle {
  Lattice lattice;
  ModelledLens lens;
  std::vector<BundleView> views;
  Eigen::Vector2d warp_mm = Eigen::Vector2d::Zero();  // how far the middle stands out along columns and along rows
};

struct BundleFreedom {
  bool distortion = true, warp = true;
  bool regularised = true;      // mild pull of distortion to 0 and of the principal point to the middle
  bool reject_outliers = true;  // corners beyond 5 sigma, with those beyond 4, are taken out of `used`
};

struct BundleOutcome {
  bool finite = false;   // the solution has only finite numbers
  std::string messages;  // what the library printed
};

// Needs at least one view; every corner must be finite and on the lattice (std::runtime_error otherwise).
BundleOutcome solve_bundle(LensBundle& bundle, const BundleFreedom& freedom);

// The bundle linearised about its solution.
struct BundleUncertainty {
  double rms_px = 0.0;    // per axis, over the corners used
  double sigma_px = 0.0;  // the same with the degrees of freedom taken out: the corners' noise
  std::vector<std::vector<Eigen::Vector2d>> errors_px;  // per view and corner: predicted - seen; 0 for unused ones
  double step_px = 0.0;  // what another Gauss-Newton step would take off the residuals' length: small = converged
  // Of intrinsics, then (rotation vector, translation in mm) of each view's camera_from_lattice, then the warp in mm;
  // for sigma_px. Infinite when the views leave a direction undetermined.
  Eigen::MatrixXd covariance;
};

BundleUncertainty linearise(const LensBundle& bundle, const BundleFreedom& freedom);

// Covariance (px^2) of where a point at `distance_mm` that is seen at `pixel` would be projected by a repeated
// calibration: each of its boards carries the point to the repeated camera, and the camera sees their mean (mrcal's
// "mean-pcam"). What matters in use, where coefficients do not: it depends on the distance.
Eigen::Matrix2d projection_covariance(const LensBundle& bundle, const BundleUncertainty& uncertainty,
                                      const Eigen::Vector2d& pixel, double distance_mm);

// For mrcal's own tools; numbers have six decimals there. Errors: std::runtime_error.
void write_cameramodel(const ModelledLens& lens, const std::filesystem::path& file);

}  // namespace calibration
