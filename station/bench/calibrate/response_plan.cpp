#include "station/bench/calibrate/response_plan.h"

#include <numbers>
#include <tuple>

namespace station {
namespace {

constexpr int kRapid = 10, kBriefDarks = 16, kLastingDarks = 8;
constexpr int kWhiteFieldPictures = 6;  // at each place
constexpr double kWhiteFieldDistance =
    0.2;  // of the way from the camera to the platform: out of focus, filling the picture

// Facing a direction half-way between camera and lamp, over the platform's middle.
Eigen::Isometry3d panel_pose(const RigFile& rig) {
  const Eigen::Vector3d centre(0, 0, rig.platform_height_mm + rig.spectralon.plate_mm / 2);
  const Eigen::Vector3d to_camera = (rig.world_from_camera_by_tape.translation() - centre).normalized();
  const Eigen::Vector3d normal = (to_camera + (rig.front_lamp_mm - centre).normalized()).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = Eigen::Vector3d::UnitZ().cross(normal).normalized();
  pose.linear().col(1) = normal.cross(pose.linear().col(0));
  pose.linear().col(2) = normal;
  pose.translation() = centre;
  return pose;
}

// Before the lens, facing it; shifted and turned a little, so that a mark on the panel is not taken for one on the
// sensor.
Eigen::Isometry3d white_field_pose(const RigFile& rig, double across_mm, double up_mm, double turned_rad) {
  const Eigen::Isometry3d& camera = rig.world_from_camera_by_tape;
  const Eigen::Vector3d forward = camera.linear().col(2);
  const double distance =
      (Eigen::Vector3d(0, 0, rig.platform_height_mm) - camera.translation()).dot(forward) * kWhiteFieldDistance;
  Eigen::Isometry3d camera_from_panel = Eigen::Isometry3d::Identity();
  camera_from_panel.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  camera_from_panel.translation() = Eigen::Vector3d(across_mm, -up_mm, distance);
  camera_from_panel.rotate(Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ()));
  return camera * camera_from_panel;
}

struct Steps {
  std::vector<CalibrationStep>& plan;
  CalibrationRole role;
  rig::Arrangement arrangement;
  int number = 0;

  std::string add(const std::string& exposure_of = {}, int stops = 0) {
    ++number;
    const std::string id = to_text(role) + "-" + (number < 10 ? "0" : "") + std::to_string(number);
    plan.push_back({.id = id, .role = role, .arrangement = arrangement, .exposure_of = exposure_of, .stops = stops});
    return id;
  }
};

}  // namespace

void add_response_steps(const RigFile& rig, std::vector<CalibrationStep>& plan) {
  // Standing, not held: pairs of pictures may differ by noise alone.
  rig::Arrangement panel{
      .object = rig::BenchObject::spectralon, .on_platform = true, .pose = panel_pose(rig), .lamp = rig::Lamp::front};
  Steps response{plan, CalibrationRole::response, panel};
  const std::string metered = response.add();
  for (int stop = kLadderLow; stop <= kLadderHigh; ++stop) response.add(metered, stop);
  for (int stop = kLadderHigh; stop >= kLadderLow; --stop) response.add(metered, stop);
  Steps rapid{plan, CalibrationRole::rapid, panel};
  for (int i = 0; i < kRapid; ++i) rapid.add(metered);
  panel.lamp = rig::Lamp::off;
  Steps dark{plan, CalibrationRole::dark, panel};
  for (int i = 0; i < kBriefDarks; ++i) dark.add(metered, kLadderLow);
  for (int i = 0; i < kLastingDarks; ++i) dark.add(metered, kLadderHigh);
  Steps white{plan, CalibrationRole::white_field, {.object = rig::BenchObject::spectralon, .room_light = true}};
  for (const auto& [across_mm, up_mm, turned_rad] :
       {std::tuple{0.0, 0.0, 0.0}, {1.5, -1.0, std::numbers::pi / 2}, {-1.5, 1.0, std::numbers::pi}}) {
    white.arrangement.pose = white_field_pose(rig, across_mm, up_mm, turned_rad);
    const std::string first = white.add();
    for (int i = 1; i < kWhiteFieldPictures; ++i) white.add(first);
  }
}

}  // namespace station
