#include "calibration/lens.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <set>
#include <stdexcept>

#include "calibration/correspondences.h"
#include "calibration/pose.h"
#include "calibration/projection.h"

namespace calibration {
namespace {

constexpr int kFewestViews = 5;
constexpr std::size_t kFewestCornersPerView = 8;  // two tags

struct SeenCorner {
  Corner corner;
  bool used = true;
};

struct View {
  std::size_t index = 0;  // among the views that were given
  std::vector<SeenCorner> corners;
  Eigen::Isometry3d seed = Eigen::Isometry3d::Identity();  // camera_from_board
  Motion motion{};
};

// Half width and height of the board, for its warp.
Eigen::Vector2d half_size(const TagLayout& board) {
  Eigen::Vector2d half = Eigen::Vector2d::Constant(1e-9);
  for (const Tag& tag : board.tags) {
    for (const Eigen::Vector3d& corner : corners_in_object(tag)) half = half.cwiseMax(corner.head<2>().cwiseAbs());
  }
  return half;
}

// A printed board is seldom flat: its points are raised by a parabola along x and one along y.
struct BoardResidual {
  Eigen::Isometry3d seed;
  Eigen::Vector2d half_size_mm;
  Corner corner;
  double weight;  // 1 / sigma_px

  template <typename T>
  bool operator()(const T* intrinsics, const T* warp_mm, const T* motion, T* residual) const {
    const double u = corner.point.x() / half_size_mm.x(), v = corner.point.y() / half_size_mm.y();
    Point<T> point = corner.point.cast<T>();
    point.z() += warp_mm[0] * (1.0 - u * u) + warp_mm[1] * (1.0 - v * v);
    const Point<T> turned = seed.linear().cast<T>() * point;
    const Point<T> in_camera = moved(motion, turned) + seed.translation().cast<T>();
    const Eigen::Matrix<T, 2, 1> pixel = project(intrinsics, in_camera);
    residual[0] = weight * (pixel.x() - T(corner.pixel.x()));
    residual[1] = weight * (pixel.y() - T(corner.pixel.y()));
    return true;
  }
};

// What each distortion term may move in the image's corner, px; the 1-sigma width of a prior about 0. Priors on the
// coefficients themselves would not do: what a coefficient means depends on the field of view (a regularisation that
// is harmless on a 90 mm lens puts the focal length of a 137 mm one 0.1 % wrong). k3 is held at 0: in the
// corner of the narrow lens that this is for (14 degrees) it moves 0.004 px per unit. With a true k3 of 5 and without
// one, 15 views at 0.1 px leave the same 0.012 px of projection error (30 draws), while k2 itself is known to 1.5
// only.
struct DistortionPrior {
  Eigen::Vector4d weight;  // of k1 k2 p1 p2

  template <typename T>
  bool operator()(const T* intrinsics, T* residual) const {
    for (int i = 0; i < 4; ++i) residual[i] = weight[i] * intrinsics[4 + i];
    return true;
  }
};

struct WarpPrior {
  template <typename T>
  bool operator()(const T* warp_mm, T* residual) const {
    constexpr double kSigma_mm = 1.0;  // a professionally used board was found bent by that much
    residual[0] = warp_mm[0] / kSigma_mm;
    residual[1] = warp_mm[1] / kSigma_mm;
    return true;
  }
};

struct Bundle {
  cv::Size image_size;
  double focal_guess_px = 0.0;
  Eigen::Vector2d board_half_mm = Eigen::Vector2d::Ones();
  Intrinsics intrinsics{};
  std::array<double, 2> warp_mm{};
  double sigma_px = 0.1;
  std::vector<View> views{};
};

DistortionPrior distortion_prior(const Bundle& bundle) {
  const double f = bundle.focal_guess_px;
  const double r = 0.5 * std::hypot(bundle.image_size.width, bundle.image_size.height) / f;
  return {.weight = {f * std::pow(r, 3) / 100.0, f * std::pow(r, 5) / 20.0, f * r * r / 10.0, f * r * r / 10.0}};
}

[[noreturn]] void refuse(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("lens calibration: " + found + ": " + what_to_do);
}

Bundle gather(const std::vector<TagObservation>& observations, const TagLayout& board, cv::Size image_size,
              double focal_guess_px) {
  if (image_size.width < 2 || image_size.height < 2 || !(focal_guess_px > 0.0) || !std::isfinite(focal_guess_px)) {
    refuse("needs the size of the pictures and a positive guess of the focal length", "check the rig file");
  }
  Bundle bundle{.image_size = image_size, .focal_guess_px = focal_guess_px, .board_half_mm = half_size(board)};
  bundle.intrinsics = {focal_guess_px, focal_guess_px, 0.5 * (image_size.width - 1), 0.5 * (image_size.height - 1)};
  const Lens guess{.width_px = image_size.width,
                   .height_px = image_size.height,
                   .fx_px = focal_guess_px,
                   .fy_px = focal_guess_px,
                   .cx_px = bundle.intrinsics[2],
                   .cy_px = bundle.intrinsics[3]};
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const std::vector<Corner> corners = match_corners(board, observations[i]);
    if (corners.size() < kFewestCornersPerView) continue;
    const std::optional<PoseFit> pose = fit_pose(guess, board, observations[i]);
    if (!pose) continue;
    View view{.index = i, .corners = {}, .seed = pose->camera_from_object};
    for (const Corner& corner : corners) view.corners.push_back({.corner = corner});
    bundle.views.push_back(view);
  }
  return bundle;
}

void require_enough_views(const Bundle& bundle) {
  if (bundle.views.size() < kFewestViews) {
    refuse("the board is seen in " + std::to_string(bundle.views.size()) + " pictures, at least " +
               std::to_string(kFewestViews) + " with two tags each are needed",
           "take more pictures of the board");
  }
}

// Pictures that differ only by a shift leave focal length and distance undetermined.
void require_tilts(const std::vector<View>& views) {
  constexpr double kSmallest_rad = 20.0 * M_PI / 180.0;
  double largest = 0.0;
  for (const View& a : views) {
    for (const View& b : views) {
      const double cosine = a.seed.linear().col(2).dot(b.seed.linear().col(2));
      largest = std::max(largest, std::acos(std::clamp(cosine, -1.0, 1.0)));
    }
  }
  if (largest < kSmallest_rad) {
    refuse("the board's tilts differ by " + std::to_string(std::lround(largest * 180.0 / M_PI)) +
               " degrees at most, 20 are needed",
           "tilt the board to 30 or 40 degrees in several directions");
  }
}

// Corners must have been seen in 6 of the picture's 3 x 3 fields.
void require_coverage(const Bundle& bundle) {
  std::set<int> fields;
  for (const View& view : bundle.views) {
    for (const SeenCorner& seen : view.corners) {
      const int column = std::clamp(static_cast<int>(3.0 * seen.corner.pixel.x() / bundle.image_size.width), 0, 2);
      const int row = std::clamp(static_cast<int>(3.0 * seen.corner.pixel.y() / bundle.image_size.height), 0, 2);
      fields.insert(3 * row + column);
    }
  }
  if (fields.size() < 6) {
    refuse("corners lie in " + std::to_string(fields.size()) + " of the picture's 3 x 3 fields, 6 are needed",
           "bring the board to the picture's edges too");
  }
}

enum class Freedom { focal_lengths_and_poses, all };

void build(Bundle& bundle, Freedom freedom, ceres::Problem& problem) {
  for (View& view : bundle.views) {
    for (const SeenCorner& seen : view.corners) {
      if (!seen.used) continue;
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<BoardResidual, 2, 9, 2, 6>(
                                   new BoardResidual{.seed = view.seed,
                                                     .half_size_mm = bundle.board_half_mm,
                                                     .corner = seen.corner,
                                                     .weight = 1.0 / bundle.sigma_px}),
                               new ceres::HuberLoss(4.0), bundle.intrinsics.data(), bundle.warp_mm.data(),
                               view.motion.data());
    }
  }
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<DistortionPrior, 4, 9>(new DistortionPrior(distortion_prior(bundle))), nullptr,
      bundle.intrinsics.data());
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<WarpPrior, 2, 2>(new WarpPrior), nullptr,
                           bundle.warp_mm.data());
  const std::vector<int> held = freedom == Freedom::all ? std::vector<int>{8} : std::vector<int>{2, 3, 4, 5, 6, 7, 8};
  problem.SetManifold(bundle.intrinsics.data(), new ceres::SubsetManifold(9, held));
  if (freedom != Freedom::all) problem.SetParameterBlockConstant(bundle.warp_mm.data());
}

// Takes the motions into the poses, so that the next linearisation is about the solution.
void settle(Bundle& bundle) {
  for (View& view : bundle.views) {
    const Eigen::Isometry3d by = isometry_of(view.motion);
    view.seed.linear() = by.linear() * view.seed.linear();
    view.seed.translation() += by.translation();
    view.motion = {};
  }
}

bool solve(Bundle& bundle, Freedom freedom) {
  ceres::Problem problem;
  build(bundle, freedom, problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  settle(bundle);
  return summary.termination_type == ceres::CONVERGENCE;
}

Eigen::Vector2d error_px(const Bundle& bundle, const View& view, const Corner& corner) {
  std::array<double, 2> residual{};
  const Motion none{};
  BoardResidual{.seed = view.seed, .half_size_mm = bundle.board_half_mm, .corner = corner, .weight = 1.0}(
      bundle.intrinsics.data(), bundle.warp_mm.data(), none.data(), residual.data());
  return {residual[0], residual[1]};
}

// Sets sigma_px from the median of the errors, and leaves corners beyond 5 sigma out.
void judge_corners(Bundle& bundle) {
  std::vector<double> sizes;
  for (const View& view : bundle.views) {
    for (const SeenCorner& seen : view.corners) sizes.push_back(error_px(bundle, view, seen.corner).norm());
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  constexpr double kRayleighMedian = 1.1774;  // of the length of a 2D normal error, in sigmas per axis
  bundle.sigma_px = std::max(*middle / kRayleighMedian, 1e-4);
  for (View& view : bundle.views) {
    for (SeenCorner& seen : view.corners)
      seen.used = error_px(bundle, view, seen.corner).norm() < 5.0 * bundle.sigma_px;
  }
}

// Covariances for sigma_px = 1 sigma of the corners used. False when the views leave a direction undetermined.
bool take_covariance(Bundle& bundle, LensFit& fit) {
  ceres::Problem problem;
  build(bundle, Freedom::all, problem);
  ceres::Covariance covariance(ceres::Covariance::Options{});
  const std::vector<const double*> blocks{bundle.intrinsics.data(), bundle.warp_mm.data()};
  fit.covariance = Eigen::MatrixXd::Constant(9, 9, std::numeric_limits<double>::infinity());
  if (!covariance.Compute(blocks, &problem)) return false;
  Eigen::Matrix<double, 9, 9, Eigen::RowMajor> lens;
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> warp;
  covariance.GetCovarianceBlock(blocks[0], blocks[0], lens.data());
  covariance.GetCovarianceBlock(blocks[1], blocks[1], warp.data());
  fit.covariance = lens;
  fit.board_warp_sigma_mm = warp.diagonal().cwiseSqrt();
  return true;
}

LensFit report(const Bundle& bundle, std::size_t view_count) {
  LensFit fit;
  const Intrinsics& p = bundle.intrinsics;
  fit.lens = {.width_px = bundle.image_size.width,
              .height_px = bundle.image_size.height,
              .fx_px = p[0],
              .fy_px = p[1],
              .cx_px = p[2],
              .cy_px = p[3],
              .distortion = {p[4], p[5], p[6], p[7], p[8]}};
  fit.board_warp_mm = {bundle.warp_mm[0], bundle.warp_mm[1]};
  fit.view_rms_px.assign(view_count, 0.0);
  double sum = 0.0;
  for (const View& view : bundle.views) {
    double view_sum = 0.0;
    int view_count_used = 0;
    for (const SeenCorner& seen : view.corners) {
      if (!seen.used) continue;
      view_sum += error_px(bundle, view, seen.corner).squaredNorm();
      ++view_count_used;
    }
    fit.view_rms_px[view.index] = view_count_used > 0 ? std::sqrt(view_sum / (2.0 * view_count_used)) : 0.0;
    fit.corners_used += view_count_used;
    fit.corners_rejected += static_cast<int>(view.corners.size()) - view_count_used;
    sum += view_sum;
  }
  fit.rms_px = std::sqrt(sum / (2.0 * std::max(1, fit.corners_used)));
  return fit;
}

}  // namespace

LensFit fit_lens(const std::vector<TagObservation>& views, const TagLayout& board, cv::Size image_size,
                 double focal_guess_px) {
  Bundle bundle = gather(views, board, image_size, focal_guess_px);
  require_enough_views(bundle);
  require_tilts(bundle.views);
  require_coverage(bundle);
  solve(bundle, Freedom::focal_lengths_and_poses);
  bool converged = solve(bundle, Freedom::all);
  for (int round = 0; round < 2; ++round) {
    judge_corners(bundle);
    converged = solve(bundle, Freedom::all);
  }
  LensFit fit = report(bundle, views.size());
  // sigma from the residuals, with the degrees of freedom of the fit taken out
  const double residuals = 2.0 * fit.corners_used,
               parameters = 8.0 + 2.0 + 6.0 * static_cast<double>(bundle.views.size());
  if (!std::isfinite(fit.rms_px) || !(fit.lens.fx_px > 0.0) || !(fit.lens.fy_px > 0.0) || residuals <= parameters) {
    refuse("the fit went astray", "check the board's sizes and ids, and take pictures with more tags in them");
  }
  bundle.sigma_px = std::max(1e-4, fit.rms_px * std::sqrt(residuals / (residuals - parameters)));
  const bool determined = take_covariance(bundle, fit);
  fit.converged = converged && determined;
  return fit;
}

std::vector<Eigen::Vector2d> undistort_points(const Lens& lens, const std::vector<Eigen::Vector2d>& pixels) {
  if (pixels.empty()) return {};
  const cv::Matx33d matrix(lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
  std::vector<cv::Point2d> seen, straight;
  for (const Eigen::Vector2d& pixel : pixels) seen.emplace_back(pixel.x(), pixel.y());
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-12);
  cv::undistortPoints(seen, straight, matrix, std::vector<double>(lens.distortion.begin(), lens.distortion.end()),
                      cv::noArray(), matrix, until);
  std::vector<Eigen::Vector2d> out;
  for (const cv::Point2d& pixel : straight) out.emplace_back(pixel.x, pixel.y);
  return out;
}

}  // namespace calibration
