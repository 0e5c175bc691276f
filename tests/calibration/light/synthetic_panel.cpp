#include "tests/calibration/light/synthetic_panel.h"

#include <cmath>
#include <numbers>

#include "calibration/geometry/target_stand.h"
#include "calibration/light/spectralon.h"
#include "calibration/sensor/degree.h"
#include "tests/calibration/geometry/synthetic_views.h"

namespace calibration::synthetic {
namespace {

using Eigen::Vector3d;

const cv::Size kSize(600, 400);
const Vector3d kSpool(0, 0, 64);
constexpr double kLimit_rad = std::numbers::pi;  // of the platform

Vector3d normals(std::mt19937& random, double sigma) {
  std::normal_distribution<double> gauss(0.0, sigma);
  const double x = gauss(random), y = gauss(random), z = gauss(random);
  return {x, y, z};
}

Eigen::Isometry3d world_from_camera() {
  const Vector3d eye(519.6, 0, 364), forward = (kSpool - eye).normalized(),
                                     right = forward.cross(Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() << right, forward.cross(right), forward;
  out.translation() = eye;
  return out;
}

double true_panel_factor(const LampTruth& t, const Vector3d& normal, const Vector3d& to_light,
                         const Vector3d& to_camera) {
  const double cos_i = normal.dot(to_light), cos_e = normal.dot(to_camera);
  if (t.droop_of_incidence_only) return 1 + t.droop * 2 * (cos_i - std::cos(8 * kDegree));
  const Vector3d a = normal.cross(to_light).normalized(), b = normal.cross(to_camera).normalized();
  return 1 + t.droop * droop_shape(cos_i, cos_e, a.dot(b));
}

// The irradiance that comes by way of the table, summed over its squares of 20 mm out to half a metre.
Vector3d table_irradiance(const LampTruth& t, std::size_t light, const Vector3d& point, const Vector3d& normal) {
  Vector3d sum = Vector3d::Zero();
  if (t.table_albedo == 0) return sum;
  for (double x = -490; x < 500; x += 20)
    for (double y = -490; y < 500; y += 20) {
      const Vector3d lit = Vector3d(point.x() + x, point.y() + y, 0), to_light = t.positions[light] - lit,
                     to_point = point - lit;
      const double d2 = to_point.squaredNorm(), facing = -normal.dot(to_point) / std::sqrt(d2);
      if (facing <= 0) continue;
      sum += true_irradiance(t, light, lit) *
             (to_light.normalized().z() * facing * to_point.z() / std::sqrt(d2) / d2 * 400);
    }
  return sum * (t.table_albedo / std::numbers::pi);
}

Eigen::Isometry3d nudged(const Eigen::Isometry3d& pose, const Imperfections& by, std::mt19937& random) {
  Eigen::Isometry3d out = pose;
  const Vector3d turn = normals(random, by.turn_rad);
  if (turn.norm() > 0) out.linear() = pose.linear() * Eigen::AngleAxisd(turn.norm(), turn.normalized());
  out.translation() += normals(random, by.shift_mm);
  return out;
}

}  // namespace

LampTruth drawn_truth(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  LampTruth t;
  t.mu = 2 * unit(random);
  t.droop = 0.15 * unit(random);
  t.table_albedo = 0.06 * unit(random);
  for (std::size_t i = 0; i < 2; ++i) {
    t.positions[i] += 30 * (2 * Vector3d(unit(random), unit(random), unit(random)) - Vector3d::Ones());
    t.axes[i] = (kSpool - t.positions[i]).normalized() + normals(random, 3 * kDegree);
  }
  return t;
}

Vector3d true_irradiance(const LampTruth& t, std::size_t light, const Vector3d& point) {
  const Vector3d offset = t.positions[light] - point;
  const double cosine = -offset.normalized().dot(t.axes[light].normalized());
  return t.intensity * (std::pow(std::max(0.0, cosine), t.mu) / offset.squaredNorm());
}

std::vector<LightGuess> taped(const LampTruth& t, std::mt19937& random, double error_mm) {
  std::vector<LightGuess> guesses;
  for (std::size_t i = 0; i < t.positions.size(); ++i)
    guesses.push_back({.name = i == 0 ? "front lamp" : "back lamp",
                       .position = t.positions[i] + normals(random, error_mm),
                       .aim = kSpool});
  return guesses;
}

PanelBench panel_bench() {
  PanelBench bench{.camera = {.lens = narrow_lens(), .world_from_camera = world_from_camera()},
                   .centre = {0, 0, 66},
                   .lowest_mm = 31};
  for (int i = 0; i < 4; ++i) {
    Tag tag{.id = i, .size_mm = 14};
    tag.object_from_tag.translation() = Vector3d(i % 2 ? 34.5 : -34.5, i / 2 ? 34.5 : -34.5, 0);
    bench.tags.tags.push_back(tag);
  }
  return bench;
}

std::vector<Eigen::Isometry3d> panel_stands() {
  std::vector<Eigen::Isometry3d> stands;
  for (const double lean : kStandLeans_rad) stands.push_back(on_stand(lean, 88, 88, 30));
  return stands;
}

PlannedPoses planned_poses(const std::vector<LightGuess>& guesses, const std::vector<MountingCounts>& counts,
                           std::mt19937* wandering) {
  const PanelBench bench = panel_bench();
  PlannedPoses planned;
  for (const PanelMounting& mounting :
       plan_panel_mountings(bench, guesses, panel_stands(), counts, kLimit_rad, panel_options())) {
    const auto pictures = static_cast<std::size_t>(counts.at(static_cast<std::size_t>(mounting.light)).pictures);
    Eigen::Isometry3d standing;
    std::vector<double> angles;
    for (int attempt = 0; angles.size() < pictures; ++attempt) {
      standing = wandering ? put_down(mounting.platform_from_panel, *wandering) : mounting.platform_from_panel;
      angles = plan_panel_angles(bench, guesses, planned.poses, mounting.light, standing, static_cast<int>(pictures),
                                 kLimit_rad, panel_options());
      planned.asked_again += attempt > 0;
    }
    planned.mountings += 1;
    for (const double angle : angles)
      planned.poses.push_back({mounting.light, Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * standing});
  }
  return planned;
}

LightOptions panel_options() {
  return {.albedo = 0.99, .image_size = kSize};
}

PanelPictures panel_pictures(const LampTruth& t, const std::vector<PanelPose>& poses, const Imperfections& by,
                             std::mt19937& random) {
  const PanelBench bench = panel_bench();
  std::normal_distribution<double> gauss(0.0, 1.0);
  PanelPictures out;
  for (const PanelPose& pose : poses) {
    const auto light = static_cast<std::size_t>(pose.light);
    const Eigen::Isometry3d true_pose = nudged(pose.world_from_panel, by, random);
    const double output = 1 + by.drift * gauss(random);
    LightPicture picture{.name = "pose " + std::to_string(out.pictures.size() + 1)};
    if (by.monitored > 0) {
      picture.output = output * (1 + by.monitored * gauss(random));
      picture.output_sigma = by.monitored;
    }
    for (const Vector3d& cell : panel_cells(bench.white_mm, 5)) {
      PanelSpot spot{.light = pose.light,
                     .picture = static_cast<int>(out.pictures.size()),
                     .point = pose.world_from_panel * cell,
                     .normal = pose.world_from_panel.linear().col(2)};
      spot.to_camera = (bench.camera.world_from_camera.translation() - spot.point).normalized();
      const Vector3d point = true_pose * cell, normal = true_pose.linear().col(2),
                     to_light = (t.positions[light] - point).normalized(),
                     to_camera = (bench.camera.world_from_camera.translation() - point).normalized();
      spot.pixel = project(bench.camera.lens, bench.camera.world_from_camera.inverse() * point);
      if (spot.pixel.x() < 0 || spot.pixel.y() < 0 || spot.pixel.x() > kSize.width - 1 ||
          spot.pixel.y() > kSize.height - 1)
        continue;
      const double direct = std::max(0.0, normal.dot(to_light)) * true_panel_factor(t, normal, to_light, to_camera);
      const double gain = output * t.vignetting.gain(spot.pixel.x(), spot.pixel.y(), kSize);
      const Vector3d by_table = table_irradiance(t, light, point, normal);
      const Vector3d exact = gain * 0.99 / std::numbers::pi * (direct * true_irradiance(t, light, point) + by_table);
      for (int c = 0; c < 3; ++c) {
        spot.radiance[c] = exact[c] * (1 + by.noise * gauss(random));
        spot.sigma[c] = std::max(by.noise, 1e-6) * exact[c] + 1e-9;
      }
      out.spots.push_back(spot);
    }
    out.pictures.push_back(picture);
  }
  return out;
}

}  // namespace calibration::synthetic
