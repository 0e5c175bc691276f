#include "station/bench/calibrate/calibration_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calibration/geometry/target_stand.h"
#include "station/bench/calibrate/lamps.h"
#include "station/bench/calibrate/response_plan.h"
#include "station/bench/calibrate/standing_target.h"
#include "station/documents/degree.h"

namespace station {
namespace {

CalibrationStep step(CalibrationRole role, int number, const rig::Arrangement& arrangement, double angle_rad) {
  std::string id = to_text(role) + "-" + (number < 10 ? "0" : "") + std::to_string(number);
  return {.id = std::move(id),
          .role = role,
          .arrangement = arrangement,
          .platform_angle_rad = angle_rad,
          .follows_target = arrangement.stand > 0};
}

// How many pictures a mounting of a target has. A platform that a person turns is turned some fifty times in all.
// Accuracy over a hundred simulated calibrations: tests/calibration.
struct Counts {
  int lens;
  std::vector<calibration::MountingCounts> panel;  // under the lamp in front, behind
};

Counts counts_of(const RigFile& rig) {
  if (rig.turntable_driver == "manual") return {6, {{2, 7}, {2, 6}}};
  return {16, {{2, 10}, {2, 10}}};
}

// The empty platform: its ring and the tags on the table are all that is needed.
void add_platform_steps(std::vector<CalibrationStep>& plan) {
  int number = 0;
  for (int angle_deg = -60; angle_deg <= 60; angle_deg += 15)
    plan.push_back(step(CalibrationRole::turning, ++number, {.room_light = true}, angle_deg * kDegree));
}

// The board on a steep, a leaning and a nearly flat stand, once on its side, so that width and height of the picture
// are measured by the same edges; where that leaves the lens less than well known, on the fourth as well. Two stands
// would do for projections, but not for the axis (tests/calibration/geometry/platform_accuracy_test.cpp).
void add_lens_steps(const RigFile& rig, std::vector<CalibrationStep>& plan) {
  int number = 0;
  constexpr int kAlways = 3;
  int stands = 0;
  for (const auto& [stand, on_its_side] : {std::pair{1, false}, {3, true}, {4, false}, {2, true}}) {
    const bool if_needed = ++stands > kAlways;
    const rig::Arrangement board{.object = rig::BenchObject::board,
                                 .on_platform = true,
                                 .stand = stand,
                                 .on_its_side = on_its_side,
                                 .pose = standing_pose(rig, rig::BenchObject::board, stand, on_its_side),
                                 .room_light = true};
    for (const double angle : calibration::plan_board_angles(panel_bench(rig).camera, rig.board, board.pose,
                                                             counts_of(rig).lens, platform_limit_rad(rig))) {
      plan.push_back(step(CalibrationRole::lens, ++number, board, angle));
      plan.back().if_needed = if_needed;
    }
  }
}

std::vector<calibration::PanelMounting> panel_mountings(const RigFile& rig) {
  std::vector<Eigen::Isometry3d> stands;
  for (int stand = 1; stand <= static_cast<int>(calibration::kStandLeans_rad.size()); ++stand)
    stands.push_back(standing_pose(rig, rig::BenchObject::spectralon, stand, false));
  const calibration::PanelBench bench = panel_bench(rig);
  const cv::Size size(bench.camera.lens.width_px, bench.camera.lens.height_px);
  return calibration::plan_panel_mountings(bench, lamp_guesses(rig), stands, counts_of(rig).panel,
                                           platform_limit_rad(rig), light_options(rig, size));
}

rig::Arrangement standing_panel(const calibration::PanelMounting& mounting) {
  return {.object = rig::BenchObject::spectralon,
          .on_platform = true,
          .stand = mounting.stand + 1,
          .pose = mounting.platform_from_panel,
          .lamp = mounting.light == 0 ? rig::Lamp::front : rig::Lamp::back};
}

// Behind, too, the panel alone is used: the back lamp stands some 29 degrees off the camera's axis and its field of
// view ends at 7, so that tags on the lamp are in no picture.
void add_panel_steps(const std::vector<calibration::PanelMounting>& mountings, int light,
                     std::vector<CalibrationStep>& plan) {
  int number = 0;
  for (const calibration::PanelMounting& mounting : mountings)
    for (const double angle : mounting.angles_rad)
      if (mounting.light == light)
        plan.push_back(step(light == 0 ? CalibrationRole::front_light : CalibrationRole::back_light, ++number,
                            standing_panel(mounting), angle));
}

// The panel of the first mounting, turned half-way between camera and lamp, for pairs of pictures that may differ by
// noise alone.
CalibrationStep response_place(const RigFile& rig, const calibration::PanelMounting& mounting) {
  const Eigen::Vector3d centre = mounting.platform_from_panel.translation();
  const Eigen::Vector3d half =
      (rig.world_from_camera_by_tape.translation() - centre).normalized() + (rig.front_lamp_mm - centre).normalized();
  return step(CalibrationRole::response, 1, standing_panel(mounting), std::atan2(half.y(), half.x()));
}

// Facing the camera, turned away from the lamp in front, so that gloss goes elsewhere.
void add_chart_step(const RigFile& rig, std::vector<CalibrationStep>& plan) {
  if (!rig.colour_chart) return;
  const Eigen::Vector3d centre(0, 0, rig.platform_height_mm + rig.colour_chart->plate_mm / 2);
  const Eigen::Vector3d to_camera = (rig.world_from_camera_by_tape.translation() - centre).normalized();
  const Eigen::Vector3d to_lamp = (rig.front_lamp_mm - centre).normalized();
  const Eigen::Vector3d away = to_lamp - to_camera.dot(to_lamp) * to_camera;
  const Eigen::Vector3d normal = (to_camera - 0.4 * away.normalized()).normalized();  // 22 degrees from the camera
  const auto& leans = calibration::kStandLeans_rad;
  const auto nearest = std::min_element(leans.begin(), leans.end(), [&](double a, double b) {
    return std::abs(a - std::asin(normal.z())) < std::abs(b - std::asin(normal.z()));
  });
  const int stand = static_cast<int>(nearest - leans.begin()) + 1;
  plan.push_back(step(CalibrationRole::colour, 1,
                      {.object = rig::BenchObject::colour_chart,
                       .on_platform = true,
                       .stand = stand,
                       .pose = standing_pose(rig, rig::BenchObject::colour_chart, stand, false),
                       .lamp = rig::Lamp::front},
                      std::atan2(normal.y(), normal.x())));
}

}  // namespace

std::vector<CalibrationStep> make_calibration_plan(const RigFile& rig) {
  const std::vector<calibration::PanelMounting> mountings = panel_mountings(rig);
  std::vector<CalibrationStep> plan;
  add_platform_steps(plan);
  add_lens_steps(rig, plan);
  add_white_field_steps(rig, plan);
  add_response_steps(response_place(rig, mountings.front()), plan);
  add_panel_steps(mountings, 0, plan);
  add_chart_step(rig, plan);
  add_dark_steps(plan);
  add_panel_steps(mountings, 1, plan);
  return plan;
}

std::vector<int> actions_of(const std::vector<CalibrationStep>& plan) {
  std::vector<int> actions;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const bool another = i == 0 || !rig::same_arrangement(plan[i - 1].arrangement, plan[i].arrangement);
    actions.push_back((i == 0 ? 0 : actions.back()) + another);
  }
  return actions;
}

}  // namespace station
