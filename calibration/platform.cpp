#include "calibration/platform.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include "calibration/correspondences.h"
#include "calibration/pose.h"
#include "calibration/projection.h"
#include "calibration/still_tags.h"

namespace calibration {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

[[noreturn]] void refuse(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("platform calibration: " + found + ": " + what_to_do);
}

constexpr double kBump_px = 1.0;  // between calibration pictures; corners repeat to 0.1 px

struct TaggedCorner {
  int id;
  Corner corner;
  bool used = true;
};

std::vector<TaggedCorner> tagged_corners(const TagLayout& layout, const TagObservation& seen) {
  std::vector<TaggedCorner> corners;
  for (const TagDetection& tag : seen)
    for (const Corner& corner : match_corners(layout, {tag})) corners.push_back({tag.id, corner});
  return corners;
}

// The unknowns. The axis frame is the world frame of the header, as far as it is known; each pass of the fit ends by
// making it so again. Gauge: the first angle is 0; the ring keeps its turn about the axis (given to the angles and
// the camera) and its height (given to the table and the camera).
struct Bundle {
  Intrinsics intrinsics{};
  Isometry3d camera_from_axis = Isometry3d::Identity();
  Isometry3d axis_from_ring = Isometry3d::Identity();   // at angle 0
  Isometry3d axis_from_sheet = Isometry3d::Identity();  // the tags on the table
  double sheet_height_mm = 0.0;
  std::vector<double> angles_rad;
  std::vector<std::vector<TaggedCorner>> turning, fixed;  // by view

  Motion axis_motion{};                 // of the axis frame seen from the camera
  std::array<double, 4> ring_motion{};  // two tilts (rad), x, y (mm)
  Motion sheet_motion{};
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

// `motion` turns the object about its own origin.
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

// camera <- axis <- Rz(angle) <- ring at angle 0
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

// camera <- axis <- sheet on the table
struct FixedResidual {
  const Bundle* bundle;
  Corner corner;

  template <typename T>
  bool operator()(const T* axis_motion, const T* sheet_motion, T* residual) const {
    residual_of(*bundle, axis_motion, displaced(bundle->axis_from_sheet, sheet_motion, corner.point), corner,
                residual);
    return true;
  }
};

Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
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
    refuse("the ring turns by " + std::to_string(std::lround(largest * 180.0 / M_PI)) +
               " degrees at most, 20 are needed",
           "check that the platform moves, and take views over a wider range");
  }
  const Vector3d axis = sum.normalized();
  if (axis.dot(up) < std::cos(30.0 * M_PI / 180.0)) {
    refuse("the axis and the table's normal differ by more than 30 degrees",
           "lay the sheet with the table's tags flat on the table, facing up");
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

// The whole sheet is seen best where nothing hides it; it does not move, so its tags are gathered from all views.
TagObservation gathered(const StillTags& still) {
  TagObservation seen;
  for (const auto& [id, corners] : still) seen.push_back({.id = id, .corners_px = corners});
  return seen;
}

void refuse_odd_tags(const std::set<int>& odd, const std::string& layout) {
  if (odd.empty()) return;
  std::string ids;
  for (const int id : odd) ids += (ids.empty() ? "" : ", ") + std::to_string(id);
  refuse("tags of the " + layout + " are not where the others want them: " + ids,
         "they were moved, or stand in each other's places; put them right and take the pictures again");
}

Bundle seed(const Lens& lens, const PlatformTargets& targets, const std::vector<PlatformView>& views,
            const StillTags& still) {
  Bundle bundle;
  bundle.intrinsics = intrinsics_of(lens);
  bundle.sheet_height_mm = targets.table_height_mm;
  std::vector<Isometry3d> poses;
  std::set<int> odd;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string name = "view " + std::to_string(i + 1);
    const std::optional<PoseFit> ring = fit_pose(lens, targets.ring, views[i].seen);
    if (!ring)
      refuse(name + " shows no tag of \"" + targets.ring.name + "\"", "uncover the ring or leave the view out");
    odd.insert(ring->odd_tags.begin(), ring->odd_tags.end());
    poses.push_back(ring->camera_from_object);
    bundle.turning.push_back(tagged_corners(targets.ring, views[i].seen));
    bundle.fixed.push_back(tagged_corners(targets.table, views[i].seen));
  }
  refuse_odd_tags(odd, "ring");
  const std::optional<PoseFit> sheet = fit_pose(lens, targets.table, gathered(still));
  if (!sheet || sheet->tags_used < 2)
    refuse(std::to_string(sheet ? sheet->tags_used : 0) + " of the table's tags were seen, at least 2 are needed",
           "uncover the tags on the table");
  refuse_odd_tags({sheet->odd_tags.begin(), sheet->odd_tags.end()}, "table");
  const Vector3d up = sheet->camera_from_object.linear().col(2);
  const Vector3d on_table = sheet->camera_from_object.translation() - targets.table_height_mm * up;
  const Vector3d axis = axis_direction(poses, up);
  bundle.angles_rad = seed_angles(poses, views, axis);
  const Vector3d on_axis = point_on_axis(poses, bundle.angles_rad, axis);
  bundle.camera_from_axis = frame_with_world(axis, on_axis, up, on_table, Vector3d::Zero());
  const Isometry3d axis_from_camera = bundle.camera_from_axis.inverse();
  bundle.axis_from_ring = axis_from_camera * poses.front();
  bundle.axis_from_sheet = axis_from_camera * sheet->camera_from_object;
  return bundle;
}

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

// Where the table is, in the frame of the sheet's pose.
Vector3d on_table(const Isometry3d& axis_from_sheet, double sheet_height_mm) {
  return axis_from_sheet * Vector3d(0, 0, -sheet_height_mm);
}

// Takes the motions into the poses and makes the axis frame the world frame again.
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
  const double* block = bundle.axis_motion.data();
  const std::vector<const double*> blocks{block};
  out.setConstant(std::numeric_limits<double>::infinity());
  if (!covariance.Compute(blocks, &problem)) return false;
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> motion;
  covariance.GetCovarianceBlock(block, block, motion.data());
  const std::array<Eigen::Index, 4> kept{0, 1, 3, 4};  // not the turn about the axis nor the slide along it
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j)
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = motion(kept[i], kept[j]);
  }
  return true;
}

struct Errors {
  double squares = 0.0, count = 0.0;
  void add(const Eigen::Vector2d& error) {
    squares += error.squaredNorm();
    count += 2.0;
  }
  double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }
};

struct AllErrors {
  Errors used;
  std::vector<Errors> views;   // of the corners used
  std::map<int, Errors> tags;  // of all corners
};

template <typename Visit>  // visit(view, corner, error in px)
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

AllErrors errors_of(Bundle& bundle) {
  AllErrors errors;
  errors.views.resize(bundle.turning.size());
  for_each_error(bundle, [&](std::size_t view, const TaggedCorner& seen, const Eigen::Vector2d& error) {
    errors.tags[seen.id].add(error);
    if (!seen.used) return;
    errors.used.add(error);
    errors.views[view].add(error);
  });
  return errors;
}

// Here and there the detector misses an edge of a slanting tag by a pixel: corners beyond 5 sigma stay out, sigma
// being told by the median.
void judge_corners(Bundle& bundle) {
  std::vector<double> sizes;
  for_each_error(
      bundle, [&](std::size_t, const TaggedCorner&, const Eigen::Vector2d& error) { sizes.push_back(error.norm()); });
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  constexpr double kRayleighMedian = 1.1774;  // of the length of a 2D normal error, in sigmas per axis
  const double limit_px = 5.0 * std::max(*middle / kRayleighMedian, 1e-4);
  for_each_error(bundle, [&](std::size_t, TaggedCorner& seen, const Eigen::Vector2d& error) {
    seen.used = error.norm() < limit_px;
  });
}

// Straight line of the angles over the readings; takes the offset out of the angles.
void fit_line(PlatformFit& fit) {
  const auto n = static_cast<double>(fit.readings_rad.size());
  double mean_reading = 0.0, mean_angle = 0.0, cross = 0.0, square = 0.0;
  for (std::size_t i = 0; i < fit.readings_rad.size(); ++i) {
    mean_reading += fit.readings_rad[i] / n;
    mean_angle += fit.angles_rad[i] / n;
  }
  for (std::size_t i = 0; i < fit.readings_rad.size(); ++i) {
    const double d = fit.readings_rad[i] - mean_reading;
    cross += d * (fit.angles_rad[i] - mean_angle);
    square += d * d;
  }
  fit.scale = cross / square;
  fit.offset_rad = mean_angle - fit.scale * mean_reading;
  double squares = 0.0;
  for (std::size_t i = 0; i < fit.readings_rad.size(); ++i) {
    fit.angles_rad[i] -= fit.offset_rad;
    squares += std::pow(fit.angles_rad[i] - fit.scale * fit.readings_rad[i], 2);
  }
  fit.angle_rms_rad = std::sqrt(squares / n);
}

void check(const PlatformTargets& targets, const std::vector<PlatformView>& views) {
  if (views.size() < 3) {
    refuse(std::to_string(views.size()) + " views of the turning platform were given, at least 3 are needed",
           "take more angles");
  }
  if (!(targets.table_height_mm >= 0.0) || !std::isfinite(targets.table_height_mm)) {
    refuse("the thickness of the sheet on the table is " + std::to_string(targets.table_height_mm) + " mm",
           "measure it");
  }
  double smallest = views.front().reading_rad, largest = smallest;
  for (const PlatformView& view : views) {
    if (!std::isfinite(view.reading_rad))
      refuse("a reading of the turntable is not a finite number", "check the turntable");
    smallest = std::min(smallest, view.reading_rad);
    largest = std::max(largest, view.reading_rad);
  }
  if (!(largest > smallest)) refuse("all readings of the turntable are equal", "take views at different angles");
}

void refuse_bumps(const StillTags& still, const std::vector<PlatformView>& views) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::optional<Shift> shift = shift_of(still, views[i].seen);
    if (!shift) continue;
    const auto problem = shift_problem(*shift, kBump_px, "view " + std::to_string(i + 1));
    if (problem) throw std::runtime_error("platform calibration: " + *problem);
  }
}

// A tag a little off its place is no outlier in one view, but in all of them.
void refuse_misplaced_tags(const AllErrors& errors) {
  std::vector<double> sizes;
  for (const auto& [id, tag] : errors.tags) sizes.push_back(tag.rms());
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  for (const auto& [id, tag] : errors.tags) {
    if (tag.rms() < std::max(0.5, 4.0 * *middle)) continue;
    char text[120];
    std::snprintf(text, sizeof text, "tag %d stands %.2f px from its place in the layout (the others %.2f px)", id,
                  tag.rms(), *middle);
    refuse(text, "it was moved or glued on askew; print the sheet again or put the tag right");
  }
}

// Two standard deviations, for an exact lens: what the thread's pictures can stand.
std::vector<Gate> gates_of(const PlatformFit& fit, std::size_t table_tags) {
  const double degree = M_PI / 180.0;
  const Eigen::Vector4d sigma = fit.axis_covariance.diagonal().cwiseSqrt();
  return {at_most("platform: direction of the axis, 2 sigma, deg", 2.0 * sigma.head<2>().norm() / degree, 0.02,
                  "views at other angles turn with the axis; take more angles, or a larger ring"),
          at_most("platform: position of the axis, 2 sigma, mm", 2.0 * sigma.tail<2>().norm(), 0.1,
                  "threads are looked for where the axis puts them; take more angles, or a larger ring"),
          at_most("platform: corners, px rms", fit.rms_px, 0.5,
                  "prints lie flat and light is even when corners fit; press the prints flat, mind shadows"),
          at_most("platform: turntable, deg rms about a straight line", fit.angle_rms_rad / degree, 0.1,
                  "more is backlash or lost steps; see that the platform turns freely"),
          at_most("platform: axis against the table's normal, deg", fit.axis_to_table_normal_rad / degree, 2.0,
                  "a leaning turntable moves the spool in height; level it, lay the table's tags flat"),
          at_least("platform: tags on the table", static_cast<double>(table_tags), 3.0,
                   "fewer cannot tell a bumped camera from a moved tag; uncover them")};
}

}  // namespace

PlatformFit fit_platform(const Lens& lens, const PlatformTargets& targets, const std::vector<PlatformView>& views) {
  check(targets, views);
  std::vector<TagObservation> pictures;
  for (const PlatformView& view : views) pictures.push_back(view.seen);
  const StillTags still = still_tags(targets.table, pictures);
  refuse_bumps(still, views);
  Bundle bundle = seed(lens, targets, views, still);
  bool converged = true;
  for (int pass = 0; pass < 3; ++pass) {
    converged = solve(bundle);
    if (pass < 2) judge_corners(bundle);
  }
  const AllErrors errors = errors_of(bundle);
  PlatformFit fit;
  fit.rms_px = errors.used.rms();
  if (!std::isfinite(fit.rms_px)) refuse("the fit went astray", "check the sizes and ids of the printed tags");
  refuse_misplaced_tags(errors);
  converged = take_covariance(bundle, fit.axis_covariance) && converged;
  const double unknowns = 6.0 + 4.0 + 6.0 + static_cast<double>(views.size()) - 1.0;
  fit.axis_covariance *= errors.used.squares / std::max(1.0, errors.used.count - unknowns);
  for (const Errors& view : errors.views) fit.view_rms_px.push_back(view.rms());
  fit.converged = converged;
  fit.angles_rad = bundle.angles_rad;
  for (const PlatformView& view : views) fit.readings_rad.push_back(view.reading_rad);
  fit_line(fit);
  fit.world_from_camera = bundle.camera_from_axis.inverse();
  fit.world_from_table = bundle.axis_from_sheet;
  // The bundle's angle 0 is the first view's; the platform's is where the readings are 0.
  const double first_rad = fit.angles_rad.front();
  fit.world_from_ring = Eigen::AngleAxisd(-first_rad, Vector3d::UnitZ()) * bundle.axis_from_ring;
  fit.axis_to_table_normal_rad = std::acos(std::clamp(bundle.axis_from_sheet.linear()(2, 2), -1.0, 1.0));
  fit.gates = gates_of(fit, still.size());
  return fit;
}

std::optional<AngleFit> measure_angle(const Lens& lens, const PlatformFit& platform, const TagLayout& ring,
                                      const TagObservation& seen) {
  const std::vector<Corner> corners = match_corners(ring, seen);
  if (corners.empty()) return std::nullopt;
  const std::optional<PoseFit> pose = fit_pose(lens, ring, seen);
  if (!pose) return std::nullopt;
  Bundle bundle;
  bundle.intrinsics = intrinsics_of(lens);
  bundle.camera_from_axis = platform.world_from_camera.inverse();
  bundle.axis_from_ring = platform.world_from_ring;
  const Eigen::Matrix3d turned = (platform.world_from_camera * pose->camera_from_object).linear() *
                                 platform.world_from_ring.linear().transpose();
  double angle_rad = std::atan2(turned(1, 0) - turned(0, 1), turned(0, 0) + turned(1, 1));
  const Motion none{};
  double squares = 0.0, slopes = 0.0;
  constexpr int kSteps = 6;  // Gauss-Newton from a pose good to a degree
  for (int step = 0; step < kSteps; ++step) {
    double gradient = 0.0;
    squares = slopes = 0.0;
    for (const Corner& corner : corners) {
      const auto error = [&](double at_rad) {
        Eigen::Vector2d r;
        TurningResidual{&bundle, corner}(none.data(), none.data(), &at_rad, r.data());
        return r;
      };
      constexpr double kStep_rad = 1e-5;
      const Eigen::Vector2d r = error(angle_rad);
      const Eigen::Vector2d slope = (error(angle_rad + kStep_rad) - error(angle_rad - kStep_rad)) / (2.0 * kStep_rad);
      gradient += slope.dot(r);
      slopes += slope.squaredNorm();
      squares += r.squaredNorm();
    }
    angle_rad -= gradient / slopes;
  }
  const double residuals = 2.0 * static_cast<double>(corners.size());
  return AngleFit{.angle_rad = angle_rad,
                  .sigma_rad = std::sqrt(squares / (residuals - 1.0) / slopes),
                  .rms_px = std::sqrt(squares / residuals),
                  .tags_used = static_cast<int>(corners.size() / 4)};
}

}  // namespace calibration
