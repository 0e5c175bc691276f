#include "calibration/pose.h"

#include <ceres/ceres.h>

#include <limits>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "calibration/correspondences.h"
#include "calibration/projection.h"

namespace calibration {
namespace {

using Corners = std::vector<Corner>;

struct PoseResidual {
  Intrinsics intrinsics;
  Eigen::Isometry3d seed;  // camera_from_object
  Corner corner;

  template <typename T>
  bool operator()(const T* motion, T* residual) const {
    const std::array<T, 9> lens = constants<T>(intrinsics);
    // The motion turns about the object's origin: rotate, then add where the seed has that origin.
    const Eigen::Vector3d turned = seed.linear() * corner.point;
    const Point<T> in_camera = moved(motion, Point<T>(turned.cast<T>())) + seed.translation().cast<T>();
    const Eigen::Matrix<T, 2, 1> pixel = project(lens.data(), in_camera);
    residual[0] = pixel.x() - T(corner.pixel.x());
    residual[1] = pixel.y() - T(corner.pixel.y());
    return true;
  }
};

bool lies_in_a_plane(const Corners& corners) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(corners.size()));
  for (std::size_t i = 0; i < corners.size(); ++i) points.col(static_cast<Eigen::Index>(i)) = corners[i].point;
  points.colwise() -= points.rowwise().mean().eval();
  const Eigen::Vector3d spread = points.jacobiSvd().singularValues();
  return spread[2] < 1e-6 * spread[0];
}

std::vector<Eigen::Isometry3d> seeds(const Lens& lens, const Corners& corners) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const Corner& corner : corners) {
    points.emplace_back(corner.point.x(), corner.point.y(), corner.point.z());
    pixels.emplace_back(corner.pixel.x(), corner.pixel.y());
  }
  const cv::Matx33d matrix(lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
  const std::vector<double> distortion(lens.distortion.begin(), lens.distortion.end());
  std::vector<cv::Mat> rotations, translations;
  cv::solvePnPGeneric(points, pixels, matrix, distortion, rotations, translations, false,
                      lies_in_a_plane(corners) ? cv::SOLVEPNP_IPPE : cv::SOLVEPNP_SQPNP);
  std::vector<Eigen::Isometry3d> out;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const cv::Mat1d &r = rotations[i], &t = translations[i];
    const Motion pose{r(0), r(1), r(2), t(0), t(1), t(2)};
    if (Eigen::Map<const Eigen::Matrix<double, 6, 1>>(pose.data()).allFinite()) out.push_back(isometry_of(pose));
  }
  return out;
}

// Moves `pose` to the nearest minimum; returns its cost. `covariance` is filled when it is asked for.
double refine(const Intrinsics& intrinsics, const Corners& corners, PoseFit& fit, bool with_covariance) {
  Motion motion{};
  ceres::Problem problem;
  for (const Corner& corner : corners) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PoseResidual, 2, 6>(new PoseResidual{
                                 .intrinsics = intrinsics, .seed = fit.camera_from_object, .corner = corner}),
                             new ceres::HuberLoss(1.0), motion.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const Eigen::Isometry3d moved_by = isometry_of(motion);
  fit.camera_from_object.linear() = moved_by.linear() * fit.camera_from_object.linear();
  fit.camera_from_object.translation() += moved_by.translation();
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  if (with_covariance) {
    ceres::Covariance::Options covariance_options;
    covariance_options.algorithm_type = ceres::DENSE_SVD;
    ceres::Covariance covariance(covariance_options);
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> block;
    const std::vector<std::pair<const double*, const double*>> blocks{{motion.data(), motion.data()}};
    if (covariance.Compute(blocks, &problem)) {
      covariance.GetCovarianceBlock(motion.data(), motion.data(), block.data());
    } else {
      block.setConstant(std::numeric_limits<double>::infinity());
      fit.converged = false;
    }
    fit.covariance = block;
  }
  return summary.final_cost;
}

double squared_error(const Intrinsics& intrinsics, const Corners& corners,
                     const Eigen::Isometry3d& camera_from_object) {
  double sum = 0.0;
  for (const Corner& corner : corners) {
    const Point<double> in_camera = camera_from_object * corner.point;
    sum += (project(intrinsics.data(), in_camera) - corner.pixel).squaredNorm();
  }
  return sum;
}

}  // namespace

std::optional<PoseFit> fit_pose(const Lens& lens, const TagLayout& layout, const TagObservation& seen) {
  return fit_pose(lens, match_corners(layout, seen));
}

std::optional<PoseFit> fit_pose(const Lens& lens, const Corners& corners) {
  if (corners.size() < 4) return std::nullopt;
  const Intrinsics intrinsics = intrinsics_of(lens);
  PoseFit best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const Eigen::Isometry3d& seed : seeds(lens, corners)) {
    PoseFit candidate;
    candidate.camera_from_object = seed;
    const double cost = refine(intrinsics, corners, candidate, false);
    const bool in_front = (candidate.camera_from_object * corners.front().point).z() > 0.0;
    if (in_front && cost < best_cost) {
      best = candidate;
      best_cost = cost;
    }
  }
  if (best_cost == std::numeric_limits<double>::infinity())
    return std::nullopt;                    // corners that no camera could see so
  refine(intrinsics, corners, best, true);  // once more about the solution, where the covariance is meant
  const double squares = squared_error(intrinsics, corners, best.camera_from_object);
  const double residuals = 2.0 * static_cast<double>(corners.size());
  best.rms_px = std::sqrt(squares / residuals);
  best.tags_used = static_cast<int>(corners.size() / 4);
  best.covariance *= squares / (residuals - 6.0);
  return best;
}

}  // namespace calibration
