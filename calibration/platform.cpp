#include "calibration/platform.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "calibration/correspondences.h"
#include "calibration/pose.h"
#include "calibration/projection.h"

namespace calibration {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

[[noreturn]] void refuse(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("platform calibration: " + found + ": " + what_to_do);
}

// The unknowns. The axis frame is the world frame of the header, as far as it is known; each pass of the fit ends by
// making it so again. Gauge: the first angle is 0; the board keeps its turn about the axis (given to the angles and
// the camera) and its height (given to the table and the camera).
struct Bundle {
  Intrinsics intrinsics{};
  Isometry3d camera_from_axis = Isometry3d::Identity();
  Isometry3d axis_from_board = Isometry3d::Identity();  // at angle 0
  Isometry3d axis_from_table = Isometry3d::Identity();  // the table is its plane z = 0
  double board_thickness_mm = 0.0;
  std::vector<double> angles_rad;
  std::vector<std::vector<Corner>> turning, flat;
  std::vector<std::array<double, 3>> flat_places;  // of each flat view: turn (rad), x, y (mm) on the table

  Motion axis_motion{};                  // of the axis frame seen from the camera
  std::array<double, 4> board_motion{};  // two tilts (rad), x, y (mm)
  std::array<double, 3> table_motion{};  // two tilts (rad), height (mm)
};

template <typename T>
Point<T> turned_about_z(const T& angle, const Point<T>& p) {
  using std::cos, std::sin;
  return {cos(angle) * p.x() - sin(angle) * p.y(), sin(angle) * p.x() + cos(angle) * p.y(), p.z()};
}

template <typename T>
Point<T> times(const Isometry3d& b_from_a, const Point<T>& p) {
  return b_from_a.linear().cast<T>() * p + b_from_a.translation().cast<T>();
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

// camera <- axis <- Rz(angle) <- board at angle 0
struct TurningResidual {
  const Bundle* bundle;
  Corner corner;

  template <typename T>
  bool operator()(const T* axis_motion, const T* board_motion, const T* angle_rad, T* residual) const {
    const std::array<T, 6> motion{board_motion[0], board_motion[1], T(0), board_motion[2], board_motion[3], T(0)};
    const Vector3d rotated = bundle->axis_from_board.linear() * corner.point;
    const Point<T> at_zero =
        moved(motion.data(), Point<T>(rotated.cast<T>())) + bundle->axis_from_board.translation().cast<T>();
    residual_of(*bundle, axis_motion, turned_about_z(*angle_rad, at_zero), corner, residual);
    return true;
  }
};

// camera <- axis <- table <- board lying on it
struct FlatResidual {
  const Bundle* bundle;
  Corner corner;

  template <typename T>
  bool operator()(const T* axis_motion, const T* table_motion, const T* place, T* residual) const {
    Point<T> on_table = turned_about_z(place[0], Point<T>(corner.point.cast<T>()));
    on_table += Point<T>(place[1], place[2], T(bundle->board_thickness_mm));
    const std::array<T, 6> motion{table_motion[0], table_motion[1], T(0), T(0), T(0), table_motion[2]};
    residual_of(*bundle, axis_motion, moved(motion.data(), times(bundle->axis_from_table, on_table)), corner,
                residual);
    return true;
  }
};

Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Isometry3d pose_of(const Lens& lens, const TagLayout& board, const TagObservation& seen, const std::string& view) {
  const std::optional<PoseFit> pose = fit_pose(lens, board, seen);
  if (!pose)
    refuse(view + " shows no tag of \"" + board.name + "\"", "turn the board to the camera or leave the view out");
  return pose->camera_from_object;
}

// Direction of the axis in the camera frame, along `up`: the mean of the turns from the first view, the larger ones
// weigh more.
Vector3d axis_direction(const std::vector<Isometry3d>& poses, const Vector3d& up) {
  Vector3d sum = Vector3d::Zero();
  double largest = 0.0;
  for (const Isometry3d& pose : poses) {
    const Vector3d turn = rotation_vector(pose.linear() * poses.front().linear().transpose());
    sum += turn.dot(up) < 0.0 ? Vector3d(-turn) : turn;
    largest = std::max(largest, turn.norm());
  }
  if (largest < 20.0 * M_PI / 180.0) {
    refuse("the board turns by " + std::to_string(std::lround(largest * 180.0 / M_PI)) +
               " degrees at most, 20 are needed",
           "check that the platform moves, and take views over a wider range");
  }
  const Vector3d axis = sum.normalized();
  if (axis.dot(up) < std::cos(30.0 * M_PI / 180.0)) {
    refuse("the axis and the board on the table differ by more than 30 degrees",
           "lay the board flat on the table, facing up");
  }
  return axis;
}

// Angles about `axis`, counted from the first view, whole turns taken from the readings.
std::vector<double> seed_angles(const std::vector<Isometry3d>& poses, const std::vector<PlatformView>& views,
                                const Vector3d& axis) {
  std::vector<double> angles;
  double agreement = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    angles.push_back(rotation_vector(poses[i].linear() * poses.front().linear().transpose()).dot(axis));
    agreement += std::sin(angles[i]) * std::sin(views[i].reading_rad - views.front().reading_rad);
  }
  const double sense = agreement < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double expected = sense * (views[i].reading_rad - views.front().reading_rad);
    angles[i] += 2.0 * M_PI * std::round((expected - angles[i]) / (2.0 * M_PI));
  }
  return angles;
}

// A point of the axis: the one that the turns leave in place, (1 - A_i) c = p_i - A_i p_0.
Vector3d point_on_axis(const std::vector<Isometry3d>& poses, const std::vector<double>& angles,
                       const Vector3d& axis) {
  Eigen::Matrix3d normal = axis * axis.transpose();  // along the axis any point will do
  Vector3d right = axis * axis.dot(poses.front().translation());
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angles[i], axis).toRotationMatrix();
    const Eigen::Matrix3d m = Eigen::Matrix3d::Identity() - turn;
    normal += m.transpose() * m;
    right += m.transpose() * (poses[i].translation() - turn * poses.front().translation());
  }
  return normal.ldlt().solve(right);
}

// The world frame of the header from an axis, a point on it, the table's plane and the camera, all in one frame.
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

Bundle seed(const Lens& lens, const TagLayout& board, const std::vector<PlatformView>& turning,
            const std::vector<TagObservation>& table_views, double board_thickness_mm) {
  Bundle bundle;
  bundle.intrinsics = intrinsics_of(lens);
  bundle.board_thickness_mm = board_thickness_mm;
  std::vector<Isometry3d> poses, flat_poses;
  for (std::size_t i = 0; i < turning.size(); ++i) {
    poses.push_back(pose_of(lens, board, turning[i].seen, "turning view " + std::to_string(i + 1)));
    bundle.turning.push_back(match_corners(board, turning[i].seen));
  }
  Vector3d up = Vector3d::Zero(), on_table = Vector3d::Zero();
  for (std::size_t i = 0; i < table_views.size(); ++i) {
    flat_poses.push_back(pose_of(lens, board, table_views[i], "table view " + std::to_string(i + 1)));
    bundle.flat.push_back(match_corners(board, table_views[i]));
    const Vector3d normal = flat_poses.back().linear().col(2);
    up += normal;
    on_table +=
        (flat_poses.back().translation() - board_thickness_mm * normal) / static_cast<double>(table_views.size());
  }
  up.normalize();
  const Vector3d axis = axis_direction(poses, up);
  bundle.angles_rad = seed_angles(poses, turning, axis);
  const Vector3d on_axis = point_on_axis(poses, bundle.angles_rad, axis);
  bundle.camera_from_axis = frame_with_world(axis, on_axis, up, on_table, Vector3d::Zero());
  const Isometry3d axis_from_camera = bundle.camera_from_axis.inverse();
  bundle.axis_from_board = axis_from_camera * poses.front();
  bundle.axis_from_table.linear() =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis_from_camera.linear() * up).toRotationMatrix();
  for (const Isometry3d& pose : flat_poses) {
    const Isometry3d table_from_board = bundle.axis_from_table.inverse() * axis_from_camera * pose;
    bundle.flat_places.push_back({std::atan2(table_from_board.linear()(1, 0), table_from_board.linear()(0, 0)),
                                  table_from_board.translation().x(), table_from_board.translation().y()});
  }
  return bundle;
}

void build(Bundle& bundle, ceres::Problem& problem) {
  for (std::size_t i = 0; i < bundle.turning.size(); ++i) {
    for (const Corner& corner : bundle.turning[i]) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<TurningResidual, 2, 6, 4, 1>(new TurningResidual{&bundle, corner}),
          new ceres::HuberLoss(1.0), bundle.axis_motion.data(), bundle.board_motion.data(), &bundle.angles_rad[i]);
    }
  }
  for (std::size_t i = 0; i < bundle.flat.size(); ++i) {
    for (const Corner& corner : bundle.flat[i]) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<FlatResidual, 2, 6, 3, 3>(new FlatResidual{&bundle, corner}),
          new ceres::HuberLoss(1.0), bundle.axis_motion.data(), bundle.table_motion.data(),
          bundle.flat_places[i].data());
    }
  }
  problem.SetParameterBlockConstant(&bundle.angles_rad.front());
}

// Takes the motions into the poses and makes the axis frame the world frame again.
void settle(Bundle& bundle) {
  const auto& b = bundle.board_motion;
  const Isometry3d board_motion = isometry_of({b[0], b[1], 0.0, b[2], b[3], 0.0});
  bundle.axis_from_board.linear() = board_motion.linear() * bundle.axis_from_board.linear();
  bundle.axis_from_board.translation() += board_motion.translation();
  const auto& t = bundle.table_motion;
  bundle.axis_from_table = isometry_of({t[0], t[1], 0.0, 0.0, 0.0, t[2]}) * bundle.axis_from_table;
  bundle.camera_from_axis = bundle.camera_from_axis * isometry_of(bundle.axis_motion);
  bundle.axis_motion = {};
  bundle.board_motion = {};
  bundle.table_motion = {};
  const Vector3d camera = bundle.camera_from_axis.inverse().translation();
  const Isometry3d axis_from_world =
      frame_with_world(Vector3d::UnitZ(), Vector3d::Zero(), bundle.axis_from_table.linear().col(2),
                       bundle.axis_from_table.translation(), camera);
  bundle.camera_from_axis = bundle.camera_from_axis * axis_from_world;
  bundle.axis_from_board = axis_from_world.inverse() * bundle.axis_from_board;
  bundle.axis_from_table = axis_from_world.inverse() * bundle.axis_from_table;
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

// For errors of 1 px per axis; false when the views leave a direction undetermined.
bool take_covariance(Bundle& bundle, Eigen::Matrix4d& out) {
  ceres::Problem problem;
  build(bundle, problem);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  const std::vector<const double*> blocks{bundle.axis_motion.data()};
  out.setConstant(std::numeric_limits<double>::infinity());
  if (!covariance.Compute(blocks, &problem)) return false;
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> motion;
  covariance.GetCovarianceBlock(blocks[0], blocks[0], motion.data());
  const std::array<Eigen::Index, 4> kept{0, 1, 3, 4};  // not the turn about the axis nor the slide along it
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = motion(kept[i], kept[j]);
  }
  return true;
}

struct Errors {
  double squares = 0.0;
  double count = 0.0;
};

Errors errors_of(const Bundle& bundle) {
  Errors errors;
  const Motion none{};
  const auto add = [&](const auto& residual_block, const double* second, const double* third) {
    std::array<double, 2> r{};
    residual_block(none.data(), second, third, r.data());
    errors.squares += r[0] * r[0] + r[1] * r[1];
    errors.count += 2.0;
  };
  for (std::size_t i = 0; i < bundle.turning.size(); ++i) {
    for (const Corner& corner : bundle.turning[i])
      add(TurningResidual{&bundle, corner}, none.data(), &bundle.angles_rad[i]);
  }
  for (std::size_t i = 0; i < bundle.flat.size(); ++i) {
    for (const Corner& corner : bundle.flat[i])
      add(FlatResidual{&bundle, corner}, none.data(), bundle.flat_places[i].data());
  }
  return errors;
}

// Straight line of the angles over the readings; takes the offset out of the angles.
void fit_line(const std::vector<PlatformView>& views, PlatformFit& fit) {
  const auto n = static_cast<double>(views.size());
  double mean_reading = 0.0, mean_angle = 0.0, cross = 0.0, square = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    mean_reading += views[i].reading_rad / n;
    mean_angle += fit.angles_rad[i] / n;
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double d = views[i].reading_rad - mean_reading;
    cross += d * (fit.angles_rad[i] - mean_angle);
    square += d * d;
  }
  fit.scale = cross / square;
  fit.offset_rad = mean_angle - fit.scale * mean_reading;
  double squares = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    fit.angles_rad[i] -= fit.offset_rad;
    squares += std::pow(fit.angles_rad[i] - fit.scale * views[i].reading_rad, 2);
  }
  fit.angle_rms_rad = std::sqrt(squares / n);
}

void check(const std::vector<PlatformView>& turning, const std::vector<TagObservation>& table_views,
           double board_thickness_mm) {
  if (turning.size() < 3) {
    refuse(std::to_string(turning.size()) + " views of the turning board were given, at least 3 are needed",
           "take more angles");
  }
  if (table_views.empty()) refuse("no view of the board lying on the table was given", "take one");
  if (!(board_thickness_mm >= 0.0) || !std::isfinite(board_thickness_mm)) {
    refuse("the board's thickness is " + std::to_string(board_thickness_mm) + " mm", "measure it");
  }
  double smallest = turning.front().reading_rad, largest = smallest;
  for (const PlatformView& view : turning) {
    if (!std::isfinite(view.reading_rad))
      refuse("a reading of the turntable is not a finite number", "check the turntable");
    smallest = std::min(smallest, view.reading_rad);
    largest = std::max(largest, view.reading_rad);
  }
  if (!(largest > smallest)) refuse("all readings of the turntable are equal", "take views at different angles");
}

}  // namespace

PlatformFit fit_platform(const Lens& lens, const TagLayout& board, const std::vector<PlatformView>& turning,
                         const std::vector<TagObservation>& table_views, double board_thickness_mm) {
  check(turning, table_views, board_thickness_mm);
  Bundle bundle = seed(lens, board, turning, table_views, board_thickness_mm);
  bool converged = true;
  for (int pass = 0; pass < 2; ++pass) converged = solve(bundle);
  PlatformFit fit;
  converged = take_covariance(bundle, fit.axis_covariance) && converged;
  const Errors errors = errors_of(bundle);
  const double unknowns =
      6.0 + 4.0 + 3.0 + static_cast<double>(turning.size()) - 1.0 + 3.0 * static_cast<double>(table_views.size());
  fit.axis_covariance *= errors.squares / std::max(1.0, errors.count - unknowns);
  fit.rms_px = std::sqrt(errors.squares / errors.count);
  if (!std::isfinite(fit.rms_px)) refuse("the fit went astray", "check the board's sizes and ids");
  fit.converged = converged;
  fit.angles_rad = bundle.angles_rad;
  fit_line(turning, fit);
  fit.world_from_camera = bundle.camera_from_axis.inverse();
  // The bundle's angle 0 is the first view's; the platform's is where the readings are 0.
  fit.world_from_board = Eigen::AngleAxisd(-fit.angles_rad.front(), Vector3d::UnitZ()) * bundle.axis_from_board;
  fit.axis_to_table_normal_rad = std::acos(std::clamp(bundle.axis_from_table.linear()(2, 2), -1.0, 1.0));
  return fit;
}

}  // namespace calibration
