// Lens calibration by mrcal 2.2 (which is used nowhere else): the bundle over lens, board poses and board warp, and its
// uncertainty.
//
// Lattice points and poses in mm, pixels with the centre of the first pixel at (0, 0), camera axes as in OpenCV.
// mrcal's own RMS is not used: it counts masked corners and regularisation terms as if they were measurements.
// What the library prints on standard error is caught. Source: mrcal.secretsauce.net, mrcal.h 2.2.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calibration/geometry/lattice.h"

namespace calibration {

enum class LensModel { opencv4, opencv5, opencv8 };

// fx fy cx cy k1 k2 p1 p2 (k3 (k4 k5 k6)), OpenCV's order.
struct ModelledLens {
  LensModel model = LensModel::opencv5;
  cv::Size image_size;
  std::vector<double> intrinsics;
};

int number_of_intrinsics(LensModel model);

// The lens in another model: coefficients that `lens` lacks are 0, surplus ones are dropped.
ModelledLens as(LensModel model, ModelledLens lens);

Eigen::Vector2d project_with(const ModelledLens& lens, const Eigen::Vector3d& point_in_camera);
Eigen::Vector3d ray_of(const ModelledLens& lens, const Eigen::Vector2d& pixel);  // unit

struct BundlePicture {
  BoardPicture corners;
  std::vector<bool> used;  // one per corner
  Eigen::Isometry3d camera_from_lattice = Eigen::Isometry3d::Identity();
};

// The unknowns of a calibration: a first guess before solve_bundle, the solution after it.
struct LensBundle {
  Lattice lattice;
  ModelledLens lens;
  std::vector<BundlePicture> pictures;
  Eigen::Vector2d warp_mm = Eigen::Vector2d::Zero();  // how far the board's middle stands out along columns and rows
};

struct BundleFreedom {
  bool distortion = true, warp = true;
  bool regularised = true;      // pulls distortion mildly to 0 and the principal point to the middle
  bool reject_outliers = true;  // corners beyond 5 sigma, with those beyond 4, are taken out of `used`
};

struct BundleOutcome {
  bool finite = false;   // whether all numbers of the solution are finite
  std::string messages;  // what the library printed
};

// Solves the bundle. Throws std::runtime_error when there is no picture or a corner is not finite or not on the
// lattice.
BundleOutcome solve_bundle(LensBundle& bundle, const BundleFreedom& freedom);

// The bundle linearised about its solution.
struct BundleUncertainty {
  double rms_px = 0.0;    // per axis, over the corners used
  double sigma_px = 0.0;  // the corners' noise: rms_px with the degrees of freedom taken out
  std::vector<std::vector<Eigen::Vector2d>> errors_px;  // per picture and corner: predicted - seen; 0 for unused ones
  double step_px = 0.0;  // what another Gauss-Newton step would take off the residuals' length; small: converged
  // Covariance of the intrinsics, then of (rotation vector, translation in mm) of each picture's camera_from_lattice,
  // then of the warp in mm, for noise of sigma_px. Infinite when the pictures leave a direction undetermined.
  Eigen::MatrixXd covariance;
};

BundleUncertainty linearise(const LensBundle& bundle, const BundleFreedom& freedom);

// The covariance (px^2) of the position at which a repeated calibration would project a point that is now seen at
// `pixel` and is `distance_mm` away: each board of the calibration carries the point to the repeated camera, which sees
// the mean of them (mrcal's "mean-pcam"). Unlike the errors of coefficients, this is the error met in use; it depends
// on the distance.
Eigen::Matrix2d projection_covariance(const LensBundle& bundle, const BundleUncertainty& uncertainty,
                                      const Eigen::Vector2d& pixel, double distance_mm);

// Writes the lens to a file for mrcal's own tools, numbers with six decimals. Errors: std::runtime_error.
void write_cameramodel(const ModelledLens& lens, const std::filesystem::path& file);

}  // namespace calibration
