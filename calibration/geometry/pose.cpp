#include "calibration/geometry/pose.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <set>
#include <vector>

#include "calibration/geometry/correspondences.h"
#include "calibration/geometry/projection.h"
#include "calibration/sensor/median.h"

namespace calibration {
namespace {

using Corners = std::vector<Corner>;
using Eigen::Isometry3d;

// A corner and the camera that saw it. The parent is the frame in which the pose is wanted.
struct Seen {
  Isometry3d camera_from_parent;
  Corner corner;
};

struct PoseResidual {
  Intrinsics intrinsics;
  Isometry3d seed;  // parent_from_object
  Seen seen;

  template <typename T>
  bool operator()(const T* motion, T* residual) const {
    const std::array<T, 9> lens = constants<T>(intrinsics);
    // The motion turns about the object's origin, so the seed's translation is added after it.
    const Eigen::Vector3d turned = seed.linear() * seen.corner.point;
    const Point<T> in_parent = moved(motion, Point<T>(turned.cast<T>())) + seed.translation().cast<T>();
    const Point<T> in_camera =
        seen.camera_from_parent.linear().cast<T>() * in_parent + seen.camera_from_parent.translation().cast<T>();
    const Eigen::Matrix<T, 2, 1> pixel = project(lens.data(), in_camera);
    residual[0] = pixel.x() - T(seen.corner.pixel.x());
    residual[1] = pixel.y() - T(seen.corner.pixel.y());
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

// One or two first guesses of camera_from_object.
std::vector<Isometry3d> seeds(const Lens& lens, const Corners& corners) {
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
  std::vector<Isometry3d> out;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const cv::Mat1d &r = rotations[i], &t = translations[i];
    const Motion pose{r(0), r(1), r(2), t(0), t(1), t(2)};
    if (Eigen::Map<const Eigen::Matrix<double, 6, 1>>(pose.data()).allFinite()) out.push_back(isometry_of(pose));
  }
  return out;
}

struct Solution {
  Isometry3d parent_from_object = Isometry3d::Identity();
  double cost = std::numeric_limits<double>::infinity();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  // for errors of 1 px
  bool converged = false;
};

// Moves the pose to the nearest minimum and, when asked, computes its covariance.
void refine(const Intrinsics& intrinsics, const std::vector<Seen>& corners, Solution& fit, bool with_covariance) {
  Motion motion{};
  ceres::Problem problem;
  for (const Seen& seen : corners) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PoseResidual, 2, 6>(new PoseResidual{
                                 .intrinsics = intrinsics, .seed = fit.parent_from_object, .seen = seen}),
                             new ceres::HuberLoss(1.0), motion.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  const Isometry3d moved_by = isometry_of(motion);
  fit.parent_from_object.linear() = moved_by.linear() * fit.parent_from_object.linear();
  fit.parent_from_object.translation() += moved_by.translation();
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  fit.cost = summary.final_cost;
  if (!with_covariance) return;
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

double squared_error(const Intrinsics& intrinsics, const Seen& seen, const Isometry3d& parent_from_object) {
  const Point<double> in_camera = seen.camera_from_parent * (parent_from_object * seen.corner.point);
  if (!(in_camera.z() > 0.0)) return std::numeric_limits<double>::infinity();
  return (project(intrinsics.data(), in_camera) - seen.corner.pixel).squaredNorm();
}

// The root mean square distance of a tag's four corners from where the pose puts them, px.
double tag_error(const Lens& lens, const TagLayout& layout, const TagDetection& tag, const Isometry3d& pose) {
  double squares = 0.0;
  for (const Corner& corner : match_corners(layout, {tag}))
    squares += squared_error(intrinsics_of(lens), {Isometry3d::Identity(), corner}, pose);
  return std::sqrt(squares / 4.0);
}

std::vector<Seen> seen_by_camera(const Corners& corners) {
  std::vector<Seen> seen;
  for (const Corner& corner : corners) seen.push_back({Isometry3d::Identity(), corner});
  return seen;
}

Solution best_of(const Lens& lens, const Corners& corners) {
  const std::vector<Seen> all = seen_by_camera(corners);
  Solution best;
  for (const Isometry3d& seed : seeds(lens, corners)) {
    Solution candidate{.parent_from_object = seed};
    refine(intrinsics_of(lens), all, candidate, false);
    const bool in_front = (candidate.parent_from_object * corners.front().point).z() > 0.0;
    if (in_front && candidate.cost < best.cost) best = candidate;
  }
  return best;
}

Solution best_of(const Lens& lens, const TagLayout& layout, const TagObservation& seen) {
  return best_of(lens, match_corners(layout, seen));
}

constexpr double kOdd_px = 2.0;

double median_tag_error(const Lens& lens, const TagLayout& layout, const TagObservation& tags, const Isometry3d& pose) {
  std::vector<double> errors;
  for (const TagDetection& tag : tags) errors.push_back(tag_error(lens, layout, tag, pose));
  return median(errors);
}

// The largest set of tags that agree with one pose. A pose from one tag alone predicts the others only to some pixels,
// so the limit of agreement is a quarter of a tag at first and, after a fit to those that agree, kOdd_px or 6 sigma.
TagObservation agreeing(const Lens& lens, const TagLayout& layout, const TagObservation& tags) {
  const Solution together = best_of(lens, layout, tags);
  const auto fits_all = [&](const Solution& fit) {
    return std::all_of(tags.begin(), tags.end(), [&](const TagDetection& tag) {
      return tag_error(lens, layout, tag, fit.parent_from_object) < kOdd_px;
    });
  };
  if (tags.size() < 3 || fits_all(together)) return tags;
  TagObservation best;
  for (const TagDetection& one : tags) {
    const double quarter_px = 0.25 * (one.corners_px[0] - one.corners_px[2]).norm() / std::sqrt(2.0);
    for (const Isometry3d& pose : seeds(lens, match_corners(layout, {one}))) {
      TagObservation group;
      for (const TagDetection& tag : tags)
        if (tag_error(lens, layout, tag, pose) < quarter_px) group.push_back(tag);
      if (group.size() > best.size()) best = group;
    }
  }
  if (best.size() < 3) return tags;  // no agreement, which the residuals will show
  const Isometry3d pose = best_of(lens, layout, best).parent_from_object;
  const double limit_px = std::max(kOdd_px, 6.0 * median_tag_error(lens, layout, best, pose));
  TagObservation agreed;
  for (const TagDetection& tag : tags)
    if (tag_error(lens, layout, tag, pose) < limit_px) agreed.push_back(tag);
  return agreed.size() < 3 ? tags : agreed;
}

struct Sorted {
  TagObservation agreed;
  std::vector<int> odd;
};

Sorted sorted(const Lens& lens, const TagLayout& layout, const TagObservation& seen) {
  TagObservation known;
  for (const TagDetection& tag : seen)
    if (!match_corners(layout, {tag}).empty()) known.push_back(tag);
  if (known.empty()) return {};
  Sorted out{.agreed = agreeing(lens, layout, known), .odd = {}};
  for (const TagDetection& tag : known) {
    const auto same_id = [&](const TagDetection& other) { return other.id == tag.id; };
    if (std::none_of(out.agreed.begin(), out.agreed.end(), same_id)) out.odd.push_back(tag.id);
  }
  return out;
}

// The end of both public fits: one more fit from the solution, for the covariance there, and the residuals.
template <typename Fit>
void finish(const Lens& lens, const std::vector<Seen>& corners, Solution solution, Fit& fit,
            Isometry3d& parent_from_object) {
  refine(intrinsics_of(lens), corners, solution, true);
  double squares = 0.0;
  for (const Seen& seen : corners) squares += squared_error(intrinsics_of(lens), seen, solution.parent_from_object);
  const double residuals = 2.0 * static_cast<double>(corners.size());
  parent_from_object = solution.parent_from_object;
  fit.rms_px = std::sqrt(squares / residuals);
  fit.tags_used = static_cast<int>(corners.size() / 4);
  fit.covariance = solution.covariance * squares / (residuals - 6.0);
  fit.converged = solution.converged;
}

}  // namespace

std::optional<PoseFit> fit_pose(const Lens& lens, const TagLayout& layout, const TagObservation& seen) {
  const Sorted tags = sorted(lens, layout, seen);
  if (tags.agreed.empty()) return std::nullopt;
  std::optional<PoseFit> fit = fit_pose(lens, match_corners(layout, tags.agreed));
  if (fit) fit->odd_tags = tags.odd;
  return fit;
}

std::optional<PoseFit> fit_pose(const Lens& lens, const Corners& corners) {
  if (corners.size() < 4) return std::nullopt;
  const Solution solution = best_of(lens, corners);
  if (solution.cost == std::numeric_limits<double>::infinity())
    return std::nullopt;  // no camera could see corners at these positions
  PoseFit fit;
  finish(lens, seen_by_camera(corners), solution, fit, fit.camera_from_object);
  return fit;
}

std::optional<MountedFit> fit_mounted_pose(const Lens& lens, const TagLayout& layout,
                                           const std::vector<Sighting>& sightings) {
  std::vector<Seen> corners;
  std::vector<Isometry3d> starts;  // one per sighting that has a pose of its own
  std::set<int> odd;
  for (const Sighting& sighting : sightings) {
    const Sorted tags = sorted(lens, layout, sighting.seen);
    odd.insert(tags.odd.begin(), tags.odd.end());
    for (const Corner& corner : match_corners(layout, tags.agreed))
      corners.push_back({sighting.camera_from_platform, corner});
    if (tags.agreed.empty()) continue;
    const Solution alone = best_of(lens, layout, tags.agreed);
    if (alone.cost < std::numeric_limits<double>::infinity())
      starts.push_back(sighting.camera_from_platform.inverse() * alone.parent_from_object);
  }
  Solution best;
  for (const Isometry3d& start : starts) {
    Solution candidate{.parent_from_object = start};
    refine(intrinsics_of(lens), corners, candidate, false);
    if (candidate.cost < best.cost) best = candidate;
  }
  if (best.cost == std::numeric_limits<double>::infinity()) return std::nullopt;
  MountedFit fit{.odd_tags = {odd.begin(), odd.end()}};
  finish(lens, corners, best, fit, fit.platform_from_object);
  return fit;
}

}  // namespace calibration
