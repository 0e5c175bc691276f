#include "calibration/light/light_plan.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "calibration/geometry/projection.h"
#include "calibration/light/light_model.h"
#include "calibration/sensor/degree.h"

namespace calibration {
namespace {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

constexpr double kUsedFraction = 0.84;  // part of the white square's edge, away from its border, which is blurred
constexpr int kCells = 5;
constexpr double kSpotSigma = 0.003;
constexpr double kVignettingRadius2 = 0.5;  // squared distance from the centre, in half diagonals, that threads reach
constexpr double kGainPerMm = 0.002;        // the error of the gain there that is as bad as 1 mm of a light's position

// Numbers of unknowns: a light's own (x y z, beam right and up), and the common ones (log intensity, mu, droop (2), v0,
// v1).
constexpr int kOwn = 5, kCommon = 6;
using Jet = ceres::Jet<double, kOwn + kCommon>;

struct Candidate {
  PanelPose pose;
  Eigen::MatrixXd information;  // about all unknowns: each light's own, then the common ones
};

bool inside(const PanelBench& bench, const Vector3d& world) {
  const double margin = 0.03 * bench.lens.width_px;
  const Point<double> camera = bench.world_from_camera.inverse() * world;
  if (camera.z() <= 0) return false;
  const Intrinsics intrinsics = intrinsics_of(bench.lens);
  const Vector2d pixel = project(intrinsics.data(), camera);
  return pixel.x() > margin && pixel.y() > margin && pixel.x() < bench.lens.width_px - margin &&
         pixel.y() < bench.lens.height_px - margin;
}

int tags_inside(const PanelBench& bench, const Isometry3d& world_from_panel) {
  int count = 0;
  for (const Tag& tag : bench.tags.tags) {
    bool whole = true;
    for (const Vector3d& corner : corners_in_object(tag)) whole = whole && inside(bench, world_from_panel * corner);
    count += whole;
  }
  return count;
}

bool admissible(const PanelBench& bench, const LightGuess& light, double steepest, const Isometry3d& panel) {
  const Vector3d normal = panel.linear().col(2);
  const Vector3d to_light = (light.position - panel.translation()).normalized(),
                 to_camera = (bench.world_from_camera.translation() - panel.translation()).normalized();
  if (normal.dot(to_light) < std::cos(steepest) || normal.dot(to_camera) < std::cos(steepest)) return false;
  const Vector3d mirror = 2 * normal.dot(to_light) * normal - to_light;
  if (mirror.dot(to_camera) > std::cos(20 * kDegree)) return false;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      if ((panel * Vector3d(x * bench.plate_mm, y * bench.plate_mm, 0)).z() < bench.lowest_mm) return false;
  return tags_inside(bench, panel) >= 2;
}

// The information about all unknowns in the logarithms of one picture's radiances, when the lamp's output in the
// picture is known to `gain_sigma`.
Eigen::MatrixXd picture_information(const PanelBench& bench, const LightGuess& guess, const PanelPose& pose,
                                    std::size_t lights, const LightOptions& options, double gain_sigma) {
  const BeamFrame frame(guess);
  const Intrinsics intrinsics = intrinsics_of(bench.lens);
  std::vector<Eigen::Matrix<double, kOwn + kCommon, 1>> rows;
  for (const Vector3d& cell : panel_cells(bench.white_mm, kCells)) {
    PanelSpot spot{.point = pose.world_from_panel * cell, .normal = pose.world_from_panel.linear().col(2)};
    if (!inside(bench, spot.point)) continue;
    spot.to_camera = (bench.world_from_camera.translation() - spot.point).normalized();
    const Point<double> in_camera = bench.world_from_camera.inverse() * spot.point;
    spot.pixel = project(intrinsics.data(), in_camera);
    const Jet position[] = {Jet(guess.position.x(), 0), Jet(guess.position.y(), 1), Jet(guess.position.z(), 2)};
    const Jet beam[] = {Jet(0.0, 3), Jet(0.0, 4)}, droop[] = {Jet(0.08, 7), Jet(0.0, 8)},
              vignetting[] = {Jet(0.0, 9), Jet(0.0, 10)};
    const Jet radiance = unit_radiance<Jet>(spot, position, frame.direction(beam), Jet(1.0, 6), droop, options.albedo) *
                         vignetting_gain(radius_squared(spot.pixel, options.image_size), vignetting);
    rows.push_back((log(radiance) + Jet(0.0, 5)).v);
  }
  Eigen::Matrix<double, kOwn + kCommon, kOwn + kCommon> one = decltype(one)::Zero();
  Eigen::Matrix<double, kOwn + kCommon, 1> sum = decltype(sum)::Zero();
  for (const auto& row : rows) one += row * row.transpose() / (kSpotSigma * kSpotSigma), sum += row;
  const double share = gain_sigma * gain_sigma / (kSpotSigma * kSpotSigma);
  one -= sum * sum.transpose() * (share / (kSpotSigma * kSpotSigma) / (1 + static_cast<double>(rows.size()) * share));

  const Eigen::Index own = kOwn * pose.light, common = static_cast<Eigen::Index>(kOwn * lights);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(common + kCommon, common + kCommon);
  all.block<kOwn, kOwn>(own, own) = one.topLeftCorner<kOwn, kOwn>();
  all.block<kOwn, kCommon>(own, common) = one.topRightCorner<kOwn, kCommon>();
  all.block<kCommon, kOwn>(common, own) = one.bottomLeftCorner<kCommon, kOwn>();
  all.block<kCommon, kCommon>(common, common) = one.bottomRightCorner<kCommon, kCommon>();
  return all;
}

Isometry3d facing(const Vector3d& normal, const Vector3d& centre) {
  Isometry3d pose = Isometry3d::Identity();
  const Vector3d right = Vector3d::UnitZ().cross(normal).normalized();
  pose.linear() << right, normal.cross(right), normal;
  pose.translation() = centre;
  return pose;
}

std::vector<Candidate> candidates(const PanelBench& bench, const std::vector<LightGuess>& lights, int light,
                                  const LightOptions& options) {
  const LightGuess& guess = lights[static_cast<std::size_t>(light)];
  const Vector3d to_light = (guess.position - bench.centre).normalized(),
                 to_camera = (bench.world_from_camera.translation() - bench.centre).normalized();
  const Vector3d half = (to_light + to_camera).normalized(), side = half.unitOrthogonal();
  const double steepest = std::clamp(std::acos(half.dot(to_camera)) + 12 * kDegree, 45 * kDegree, 70 * kDegree);
  const Eigen::Matrix3d& camera = bench.world_from_camera.linear();
  std::vector<Candidate> out;
  for (const double polar : {0.0, 12.0, 24.0, 36.0, 48.0})
    for (int turn = 0; turn < (polar > 0 ? 12 : 1); ++turn) {
      const Vector3d normal =
          Eigen::AngleAxisd(turn * 30 * kDegree, half) * (Eigen::AngleAxisd(polar * kDegree, side) * half);
      if (normal.z() > std::cos(3 * kDegree)) continue;  // when the panel lies flat, its up direction is arbitrary
      for (const double nearer : {-30.0, 0.0, 30.0})
        for (const double across : {-45.0, 0.0, 45.0})
          for (const double up : {-22.0, 0.0, 22.0}) {
            const PanelPose pose{light, facing(normal, bench.centre + camera * Vector3d(across, -up, -nearer))};
            if (!admissible(bench, guess, steepest, pose.world_from_panel)) continue;
            const double steepness = std::tan(std::acos(normal.dot(to_light)));
            const double tilt = (tags_inside(bench, pose.world_from_panel) == 4 ? 1 : 2) * options.pose_sigma_rad;
            const double gain_sigma = std::hypot(options.drift, tilt * steepness);
            out.push_back({pose, picture_information(bench, guess, pose, lights.size(), options, gain_sigma)});
          }
    }
  if (out.empty())
    throw std::runtime_error("no pose of the panel shows its white face to the " + guess.name +
                             " and to the camera at once: measure both positions again, or move the lamp");
  return out;
}

Eigen::MatrixXd prior_information(const std::vector<LightGuess>& lights) {
  const auto common = static_cast<Eigen::Index>(kOwn * lights.size());
  Eigen::VectorXd sigma(common + kCommon);
  for (std::size_t i = 0; i < lights.size(); ++i)
    sigma.segment<kOwn>(static_cast<Eigen::Index>(kOwn * i)) << Vector3d::Constant(lights[i].position_sigma_mm),
        Vector2d::Constant(lights[i].aim_sigma_rad);
  sigma.tail<kCommon>() << 100, 1, 0.1, 0.05, 0.5, 0.5;
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

// The sum of the squared errors (mm^2) of all lights' positions and of the gain, which is weighed by kGainPerMm.
double badness(const Eigen::MatrixXd& information, std::size_t lights) {
  const Eigen::MatrixXd covariance = information.inverse();
  double sum = 0.0;
  for (std::size_t i = 0; i < lights; ++i) {
    const auto own = static_cast<Eigen::Index>(kOwn * i);
    sum += covariance.block<3, 3>(own, own).trace();
  }
  const Vector2d gain(kVignettingRadius2 / kGainPerMm, kVignettingRadius2 * kVignettingRadius2 / kGainPerMm);
  return sum + gain.dot(covariance.bottomRightCorner<2, 2>() * gain);
}

}  // namespace

double panel_cell_mm(double white_mm, int n) {
  return white_mm * kUsedFraction / n;
}

std::vector<Vector3d> panel_cells(double white_mm, int n) {
  const double cell = panel_cell_mm(white_mm, n);
  std::vector<Vector3d> centres;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) centres.emplace_back((i - (n - 1) / 2.0) * cell, (j - (n - 1) / 2.0) * cell, 0);
  return centres;
}

std::vector<PanelPose> plan_panel_poses(const PanelBench& bench, const std::vector<LightGuess>& lights,
                                        const std::vector<int>& counts, const LightOptions& options) {
  Eigen::MatrixXd known = prior_information(lights);
  std::vector<PanelPose> plan;
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const std::vector<Candidate> offered = candidates(bench, lights, static_cast<int>(light), options);
    for (int i = 0; i < counts.at(light); ++i) {
      const Candidate* best = nullptr;
      double least = std::numeric_limits<double>::infinity();
      for (const Candidate& candidate : offered) {
        const double value = badness(known + candidate.information, lights.size());
        if (value < least) least = value, best = &candidate;
      }
      known += best->information;
      plan.push_back(best->pose);
    }
  }
  return plan;
}

}  // namespace calibration
