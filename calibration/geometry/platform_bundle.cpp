#include "calibration/geometry/platform_bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/sensor/median.h"

namespace calibration {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

template <typename T>
Point<T> turned_about_z(const T& angle, const Point<T>& p) {
  using std::cos, std::sin;
  return {cos(angle) * p.x() - sin(angle) * p.y(), sin(angle) * p.x() + cos(angle) * p.y(), p.z()};
}

template <typename T>
Point<T> times(const Isometry3d& b_from_a, const Point<T>& p) {
  return b_from_a.linear().cast<T>() * p + b_from_a.translation().cast<T>();
}

// A point of the object, in the axis frame, after `motion`, which turns the object about its own origin.
template <typename T>
Point<T> displaced(const Isometry3d& axis_from_object, const T* motion, const Vector3d& point) {
  const Vector3d rotated = axis_from_object.linear() * point;
  return moved(motion, Point<T>(rotated.cast<T>())) + axis_from_object.translation().cast<T>();
}

template <typename T>
void residual_of(const Bundle& bundle, const T* axis_motion, const Point<T>& in_axis, const Corner& corner,
                 T* residual) {
  const Point<T> in_camera = times(bundle.camera_from_axis, moved(axis_motion, in_axis));
  const std::array<T, 9> lens = constants<T>(bundle.intrinsics);
  const Eigen::Matrix<T, 2, 1> pixel = project(lens.data(), in_camera);
  residual[0] = pixel.x() - T(corner.pixel.x());
  residual[1] = pixel.y() - T(corner.pixel.y());
}

// The error of a corner on the ring, by the chain camera <- axis <- Rz(angle) <- ring at angle 0.
struct TurningResidual {
  const Bundle* bundle;
  Corner corner;

  template <typename T>
  bool operator()(const T* axis_motion, const T* ring_motion, const T* angle_rad, T* residual) const {
    const std::array<T, 6> motion{ring_motion[0], ring_motion[1], T(0), ring_motion[2], ring_motion[3], T(0)};
    const Point<T> at_zero = displaced(bundle->axis_from_ring, motion.data(), corner.point);
    residual_of(*bundle, axis_motion, turned_about_z(*angle_rad, at_zero), corner, residual);
    return true;
  }
};

// The error of a corner on the table, by the chain camera <- axis <- sheet on the table.
struct FixedResidual {
  const Bundle* bundle;
  Corner corner;

  template <typename T>
  bool operator()(const T* axis_motion, const T* sheet_motion, T* residual) const {
    residual_of(*bundle, axis_motion, displaced(bundle->axis_from_sheet, sheet_motion, corner.point), corner, residual);
    return true;
  }
};

void build(Bundle& bundle, ceres::Problem& problem) {
  for (std::size_t i = 0; i < bundle.turning.size(); ++i) {
    for (const TaggedCorner& seen : bundle.turning[i]) {
      if (!seen.used) continue;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<TurningResidual, 2, 6, 4, 1>(new TurningResidual{&bundle, seen.corner}),
          new ceres::HuberLoss(1.0), bundle.axis_motion.data(), bundle.ring_motion.data(), &bundle.angles_rad[i]);
    }
    for (const TaggedCorner& seen : bundle.fixed[i]) {
      if (!seen.used) continue;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<FixedResidual, 2, 6, 6>(new FixedResidual{&bundle, seen.corner}),
          new ceres::HuberLoss(1.0), bundle.axis_motion.data(), bundle.sheet_motion.data());
    }
  }
  problem.SetParameterBlockConstant(&bundle.angles_rad.front());
}

// A point of the table, in the axis frame.
Vector3d on_table(const Isometry3d& axis_from_sheet, double sheet_height_mm) {
  return axis_from_sheet * Vector3d(0, 0, -sheet_height_mm);
}

// Moves the poses by the motions and makes the axis frame the world frame again.
void settle(Bundle& bundle) {
  const auto apply = [](const Motion& motion, Isometry3d& pose) {
    const Isometry3d by = isometry_of(motion);
    pose.linear() = by.linear() * pose.linear();
    pose.translation() += by.translation();
  };
  const auto& r = bundle.ring_motion;
  apply({r[0], r[1], 0.0, r[2], r[3], 0.0}, bundle.axis_from_ring);
  apply(bundle.sheet_motion, bundle.axis_from_sheet);
  bundle.camera_from_axis = bundle.camera_from_axis * isometry_of(bundle.axis_motion);
  bundle.axis_motion = {};
  bundle.ring_motion = {};
  bundle.sheet_motion = {};
  const Vector3d camera = bundle.camera_from_axis.inverse().translation();
  const Isometry3d axis_from_world =
      frame_with_world(Vector3d::UnitZ(), Vector3d::Zero(), bundle.axis_from_sheet.linear().col(2),
                       on_table(bundle.axis_from_sheet, bundle.sheet_height_mm), camera);
  bundle.camera_from_axis = bundle.camera_from_axis * axis_from_world;
  bundle.axis_from_ring = axis_from_world.inverse() * bundle.axis_from_ring;
  bundle.axis_from_sheet = axis_from_world.inverse() * bundle.axis_from_sheet;
}

template <typename Visit>  // visit(picture, corner, error in px)
void for_each_error(Bundle& bundle, Visit&& visit) {
  const Motion none{};
  for (std::size_t i = 0; i < bundle.turning.size(); ++i) {
    Eigen::Vector2d error;
    for (TaggedCorner& seen : bundle.turning[i]) {
      TurningResidual{&bundle, seen.corner}(none.data(), none.data(), &bundle.angles_rad[i], error.data());
      visit(i, seen, error);
    }
    for (TaggedCorner& seen : bundle.fixed[i]) {
      FixedResidual{&bundle, seen.corner}(none.data(), none.data(), error.data());
      visit(i, seen, error);
    }
  }
}

}  // namespace

std::vector<TaggedCorner> tagged_corners(const TagLayout& layout, const TagObservation& seen) {
  std::vector<TaggedCorner> corners;
  for (const TagDetection& tag : seen)
    for (const Corner& corner : match_corners(layout, {tag})) corners.push_back({tag.id, corner});
  return corners;
}

Isometry3d frame_with_world(const Vector3d& axis, const Vector3d& on_axis, const Vector3d& table_normal,
                            const Vector3d& on_table, const Vector3d& camera) {
  const Vector3d origin = on_axis + axis * (table_normal.dot(on_table - on_axis) / table_normal.dot(axis));
  const Vector3d to_camera = camera - origin;
  Isometry3d frame = Isometry3d::Identity();
  frame.linear().col(2) = axis;
  frame.linear().col(0) = (to_camera - axis * axis.dot(to_camera)).normalized();
  frame.linear().col(1) = frame.linear().col(2).cross(frame.linear().col(0));
  frame.translation() = origin;
  return frame;
}

bool solve(Bundle& bundle) {
  ceres::Problem problem;
  build(bundle, problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = 1e-12;
  options.max_num_iterations = 100;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  settle(bundle);
  return summary.termination_type == ceres::CONVERGENCE;
}

bool take_covariance(Bundle& bundle, Eigen::Matrix4d& out) {
  ceres::Problem problem;
  build(bundle, problem);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  const double* block = bundle.axis_motion.data();
  const std::vector<const double*> blocks{block};
  out.setConstant(std::numeric_limits<double>::infinity());
  if (!covariance.Compute(blocks, &problem)) return false;
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> motion;
  covariance.GetCovarianceBlock(block, block, motion.data());
  const std::array<Eigen::Index, 4> kept{0, 1, 3, 4};  // without the turn about the axis and the slide along it
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = motion(kept[i], kept[j]);
  return true;
}

AllErrors errors_of(Bundle& bundle) {
  AllErrors errors;
  errors.pictures.resize(bundle.turning.size());
  for_each_error(bundle, [&](std::size_t picture, const TaggedCorner& seen, const Eigen::Vector2d& error) {
    errors.tags[seen.id].add(error);
    if (!seen.used) return;
    errors.used.add(error);
    errors.pictures[picture].add(error);
  });
  return errors;
}

void judge_corners(Bundle& bundle) {
  std::vector<double> sizes;
  for_each_error(
      bundle, [&](std::size_t, const TaggedCorner&, const Eigen::Vector2d& error) { sizes.push_back(error.norm()); });
  constexpr double kRayleighMedian = 1.1774;  // median length of a 2D normal error, in sigmas per axis
  const double limit_px = 5.0 * std::max(median(sizes) / kRayleighMedian, 1e-4);
  for_each_error(bundle, [&](std::size_t, TaggedCorner& seen, const Eigen::Vector2d& error) {
    seen.used = error.norm() < limit_px;
  });
}

}  // namespace calibration
