#include "calibration/light/light_plan.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "calibration/geometry/projection.h"
#include "calibration/geometry/target_stand.h"
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
constexpr double kTurnStep = 5 * kDegree;   // from one angle of the platform that is tried to the next
constexpr double kFinestStep = 1 * kDegree;

// Numbers of unknowns: a light's own (x y z, beam right and up), and the common ones (log intensity, mu, droop (2), v0,
// v1).
constexpr int kOwn = 5, kCommon = 6;
using Jet = ceres::Jet<double, kOwn + kCommon>;

struct Candidate {
  PanelPose pose;
  Eigen::MatrixXd information;  // about all unknowns: each light's own, then the common ones
};

bool admissible(const PanelBench& bench, const LightGuess& light, double steepest, const Isometry3d& panel) {
  const Vector3d normal = panel.linear().col(2);
  const Vector3d to_light = (light.position - panel.translation()).normalized(),
                 to_camera = (bench.camera.world_from_camera.translation() - panel.translation()).normalized();
  if (normal.dot(to_light) < std::cos(steepest) || normal.dot(to_camera) < std::cos(steepest)) return false;
  const Vector3d mirror = 2 * normal.dot(to_light) * normal - to_light;
  if (mirror.dot(to_camera) > std::cos(20 * kDegree)) return false;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      if ((panel * Vector3d(x * bench.plate_mm, y * bench.plate_mm, 0)).z() < bench.lowest_mm) return false;
  return tags_in_picture(bench.camera, bench.tags, panel) >= 2;
}

// The information about all unknowns in the logarithms of one picture's radiances, when the lamp's output in the
// picture is known to `gain_sigma`.
Eigen::MatrixXd picture_information(const PanelBench& bench, const LightGuess& guess, const PanelPose& pose,
                                    std::size_t lights, const LightOptions& options, double gain_sigma) {
  const BeamFrame frame(guess);
  const Intrinsics intrinsics = intrinsics_of(bench.camera.lens);
  std::vector<Eigen::Matrix<double, kOwn + kCommon, 1>> rows;
  for (const Vector3d& cell : panel_cells(bench.white_mm, kCells)) {
    PanelSpot spot{.point = pose.world_from_panel * cell, .normal = pose.world_from_panel.linear().col(2)};
    if (!in_picture(bench.camera, spot.point)) continue;
    spot.to_camera = (bench.camera.world_from_camera.translation() - spot.point).normalized();
    const Point<double> in_camera = bench.camera.world_from_camera.inverse() * spot.point;
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

// The largest angle from a panel's normal that is allowed to light and camera.
double steepest_view_rad(const PanelBench& bench, const LightGuess& guess) {
  const Vector3d to_light = (guess.position - bench.centre).normalized(),
                 to_camera = (bench.camera.world_from_camera.translation() - bench.centre).normalized();
  const double half = std::acos(to_light.dot(to_camera)) / 2;
  return std::clamp(half + 12 * kDegree, 45 * kDegree, 70 * kDegree);
}

Candidate candidate(const PanelBench& bench, const std::vector<LightGuess>& lights, const PanelPose& pose,
                    const LightOptions& options) {
  const LightGuess& guess = lights[static_cast<std::size_t>(pose.light)];
  const Vector3d normal = pose.world_from_panel.linear().col(2);
  const double steepness = std::tan(std::acos(normal.dot((guess.position - bench.centre).normalized())));
  const double tilt =
      (tags_in_picture(bench.camera, bench.tags, pose.world_from_panel) == 4 ? 1 : 2) * options.pose_sigma_rad;
  const double gain_sigma = std::hypot(options.drift, tilt * steepness);
  return {pose, picture_information(bench, guess, pose, lights.size(), options, gain_sigma)};
}

[[noreturn]] void refuse(const LightGuess& light) {
  throw std::runtime_error("no pose of the panel shows its white face to the " + light.name +
                           " and to the camera at once: measure both positions again, or move the lamp");
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

struct Turns {
  std::vector<double> angles_rad;
  Eigen::MatrixXd known;  // with their pictures
};

// Angles of the platform, one by one the most telling; each is used once.
Turns best_turns(const PanelBench& bench, const std::vector<LightGuess>& lights, const Eigen::MatrixXd& known,
                 int light, const Isometry3d& platform_from_panel, int count, double limit_rad,
                 const LightOptions& options) {
  const LightGuess& guess = lights[static_cast<std::size_t>(light)];
  const double steepest = steepest_view_rad(bench, guess);
  std::map<double, Candidate> offered;
  // In finer steps where the panel is shown over a narrow range only.
  for (double step = kTurnStep; step > kFinestStep && static_cast<int>(offered.size()) < count; step /= 2) {
    offered.clear();
    const int steps = static_cast<int>(limit_rad / step + 1e-9);
    for (int i = -steps; i <= steps; ++i) {
      const PanelPose pose{light, turned(i * step, platform_from_panel)};
      if (admissible(bench, guess, steepest, pose.world_from_panel))
        offered.emplace(i * step, candidate(bench, lights, pose, options));
    }
  }
  Turns turns{.angles_rad = {}, .known = known};
  while (static_cast<int>(turns.angles_rad.size()) < count && !offered.empty()) {
    const auto best = std::min_element(offered.begin(), offered.end(), [&](const auto& a, const auto& b) {
      return badness(turns.known + a.second.information, lights.size()) <
             badness(turns.known + b.second.information, lights.size());
    });
    turns.known += best->second.information;
    turns.angles_rad.push_back(best->first);
    offered.erase(best);
  }
  std::sort(turns.angles_rad.begin(), turns.angles_rad.end());
  return turns;
}

}  // namespace

std::vector<PanelMounting> plan_panel_mountings(const PanelBench& bench, const std::vector<LightGuess>& lights,
                                                const std::vector<Isometry3d>& stands,
                                                const std::vector<MountingCounts>& counts, double limit_rad,
                                                const LightOptions& options) {
  Eigen::MatrixXd known = prior_information(lights);
  std::vector<PanelMounting> plan;
  for (int light = 0; light < static_cast<int>(lights.size()); ++light) {
    std::set<std::size_t> used;
    const MountingCounts& count = counts.at(static_cast<std::size_t>(light));
    for (int i = 0; i < count.mountings; ++i) {
      std::optional<std::size_t> chosen;
      Turns best;
      for (std::size_t s = 0; s < stands.size(); ++s) {
        if (used.contains(s)) continue;
        Turns turns = best_turns(bench, lights, known, light, stands[s], count.pictures, limit_rad, options);
        if (turns.angles_rad.empty()) continue;
        if (chosen && badness(turns.known, lights.size()) >= badness(best.known, lights.size())) continue;
        chosen = s;
        best = std::move(turns);
      }
      if (!chosen) break;
      used.insert(*chosen);
      known = best.known;
      plan.push_back({light, static_cast<int>(*chosen), stands[*chosen], best.angles_rad});
    }
    if (used.empty()) refuse(lights[static_cast<std::size_t>(light)]);
  }
  return plan;
}

std::vector<double> plan_panel_angles(const PanelBench& bench, const std::vector<LightGuess>& lights,
                                      const std::vector<PanelPose>& earlier, int light,
                                      const Isometry3d& platform_from_panel, int count, double limit_rad,
                                      const LightOptions& options) {
  Eigen::MatrixXd known = prior_information(lights);
  for (const PanelPose& pose : earlier) known += candidate(bench, lights, pose, options).information;
  return best_turns(bench, lights, known, light, platform_from_panel, count, limit_rad, options).angles_rad;
}

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

}  // namespace calibration
