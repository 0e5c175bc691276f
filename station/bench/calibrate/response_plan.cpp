#include "station/bench/calibrate/response_plan.h"

#include <algorithm>
#include <numbers>
#include <tuple>

namespace station {
namespace {

constexpr int kRapid = 10, kBriefDarks = 16, kLastingDarks = 8;
constexpr int kWhiteFieldPictures = 6;  // at each place
constexpr double kWhiteFieldDistance =
    0.2;  // of the way from the camera to the platform: out of focus, filling the picture

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
  CalibrationStep first;  // whose place all have
  int number = 0;

  std::string add(const std::string& exposure_of = {}, int stops = 0) {
    CalibrationStep next = first;
    ++number;
    next.id = to_text(next.role) + (number < 10 ? "-0" : "-") + std::to_string(number);
    next.exposure_of = exposure_of;
    next.stops = stops;
    plan.push_back(next);
    return next.id;
  }
};

}  // namespace

void add_response_steps(CalibrationStep place, std::vector<CalibrationStep>& plan) {
  place.role = CalibrationRole::response;
  Steps response{plan, place};
  const std::string metered = response.add();
  for (int stop = kLadderLow; stop <= kLadderHigh; ++stop) response.add(metered, stop);
  for (int stop = kLadderHigh; stop >= kLadderLow; --stop) response.add(metered, stop);
  place.role = CalibrationRole::rapid;
  Steps rapid{plan, place};
  for (int i = 0; i < kRapid; ++i) rapid.add(metered);
}

void add_dark_steps(std::vector<CalibrationStep>& plan) {
  const auto metered = std::find_if(plan.begin(), plan.end(), [](const CalibrationStep& step) {
    return step.role == CalibrationRole::response && step.exposure_of.empty();
  });
  CalibrationStep place{.role = CalibrationRole::dark, .arrangement = plan.back().arrangement};
  place.arrangement.lamp = rig::Lamp::off;
  const std::string like = metered->id;
  Steps dark{plan, place};
  for (int i = 0; i < kBriefDarks; ++i) dark.add(like, kLadderLow);
  for (int i = 0; i < kLastingDarks; ++i) dark.add(like, kLadderHigh);
}

void add_white_field_steps(const RigFile& rig, std::vector<CalibrationStep>& plan) {
  Steps white{plan,
              {.role = CalibrationRole::white_field,
               .arrangement = {.object = rig::BenchObject::spectralon, .kept_moving = true, .room_light = true}}};
  for (const auto& [across_mm, up_mm, turned_rad] :
       {std::tuple{0.0, 0.0, 0.0}, {1.5, -1.0, std::numbers::pi / 2}, {-1.5, 1.0, std::numbers::pi}}) {
    white.first.arrangement.pose = white_field_pose(rig, across_mm, up_mm, turned_rad);
    const std::string first = white.add();
    for (int i = 1; i < kWhiteFieldPictures; ++i) white.add(first);
  }
}

}  // namespace station
