#include "station/bench/calibrate/calibration_plan.h"

#include <array>

#include "station/bench/calibrate/lamps.h"
#include "station/bench/calibrate/response_plan.h"
#include "station/documents/degree.h"

namespace station {
namespace {
Eigen::Matrix3d turn(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(degrees * kDegree, axis).toRotationMatrix();
}

CalibrationStep step(CalibrationRole role, int number, const rig::Arrangement& arrangement) {
  std::string id = to_text(role) + "-" + (number < 10 ? "0" : "") + std::to_string(number);
  return {.id = std::move(id), .role = role, .arrangement = arrangement};
}

// The board in the hand, facing the camera, then tilted: degrees about its own x, y and normal; millimetres across the
// picture; distance as a fraction of the distance to the platform. Tilts and depths make the focal length observable.
struct HandPose {
  double tilt_x, tilt_y, spin, across, up, distance;
};
constexpr std::array<HandPose, 16> kHandPoses{{{0, 0, 0, 0, 0, 1.0},
                                               {35, 0, 0, 0, 0, 0.95},
                                               {-35, 0, 0, 5, 0, 1.0},
                                               {0, 35, 0, 0, 5, 0.95},
                                               {0, -35, 0, -5, 0, 1.0},
                                               {30, 30, 0, 0, 0, 0.9},
                                               {-30, 30, 0, 8, -5, 1.05},
                                               {30, -30, 0, -8, 5, 1.1},
                                               {-30, -30, 0, 0, 0, 0.92},
                                               {10, 0, 90, 0, 0, 1.1},
                                               {25, -10, 45, 22, -12, 0.9},
                                               {0, 28, 180, -25, 15, 0.9},
                                               {-28, 5, 0, 32, 20, 1.1},
                                               {5, -28, 0, -32, -20, 1.1},
                                               {20, 20, 0, 38, -22, 1.0},
                                               {-20, -20, 90, -38, 22, 1.0}}};

void add_lens_steps(const RigFile& rig, std::vector<CalibrationStep>& plan) {
  const Eigen::Isometry3d& camera = rig.world_from_camera_by_tape;
  const Eigen::Vector3d forward = camera.linear().col(2);
  // Distance along the axis to the point nearest the platform's centre line at working height.
  const double distance = (Eigen::Vector3d(0, 0, rig.platform_height_mm + 34) - camera.translation()).dot(forward);
  Eigen::Matrix3d facing;  // board axes in camera axes: x right, y up, z towards the viewer
  facing << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  int number = 0;
  for (const HandPose& hand : kHandPoses) {
    Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
    camera_from_board.linear() = facing * turn(hand.tilt_x, Eigen::Vector3d::UnitX()) *
                                 turn(hand.tilt_y, Eigen::Vector3d::UnitY()) *
                                 turn(hand.spin, Eigen::Vector3d::UnitZ());
    camera_from_board.translation() = Eigen::Vector3d(hand.across, -hand.up, hand.distance * distance);
    plan.push_back(step(CalibrationRole::lens, ++number,
                        {.object = rig::BenchObject::board, .pose = camera * camera_from_board, .room_light = true}));
  }
}

// The empty platform: its ring and the tags on the table are all that is needed.
void add_platform_steps(std::vector<CalibrationStep>& plan) {
  int number = 0;
  for (int angle_deg = -60; angle_deg <= 60; angle_deg += 15) {
    CalibrationStep turning = step(CalibrationRole::turning, ++number, {.room_light = true});
    turning.platform_angle_rad = angle_deg * kDegree;
    plan.push_back(turning);
  }
}

// With 0.3 % noise, 0.5 % drift of the lamp and panels held to 0.1 degree, simulated (tests/calibration): 12 poses put
// the front lamp within 2.5 mm and the back lamp within 2.1 mm (rms), 16 within 2.2 and 2.0; with a reference chip read
// to 0.1 %, 12 do within 1.4. Behind, too, the panel alone is used: the back lamp stands some 29 degrees off the
// camera's axis and its field of view ends at 7, so that tags on the lamp are in no picture.
constexpr int kFrontPoses = 16, kBackPoses = 12;

void add_panel_steps(const RigFile& rig, std::vector<CalibrationStep>& plan) {
  const calibration::PanelBench bench = panel_bench(rig);
  const auto poses = calibration::plan_panel_poses(bench, lamp_guesses(rig), {kFrontPoses, kBackPoses},
                                                   light_options(rig, {bench.lens.width_px, bench.lens.height_px}));
  std::array<int, 2> number{};
  for (const calibration::PanelPose& pose : poses) {
    const bool front = pose.light == 0;
    plan.push_back(step(front ? CalibrationRole::front_light : CalibrationRole::back_light,
                        ++number.at(static_cast<std::size_t>(pose.light)),
                        {.object = rig::BenchObject::spectralon,
                         .pose = pose.world_from_panel,
                         .lamp = front ? rig::Lamp::front : rig::Lamp::back}));
  }
}

// Facing the camera, turned away from the lamp in front, so that gloss goes elsewhere.
void add_chart_step(const RigFile& rig, std::vector<CalibrationStep>& plan) {
  if (!rig.colour_chart) return;
  const Eigen::Vector3d centre(18, 0, rig.platform_height_mm + rig.colour_chart->plate_mm / 2 + 6);
  const Eigen::Vector3d to_camera = (rig.world_from_camera_by_tape.translation() - centre).normalized();
  const Eigen::Vector3d to_lamp = (rig.front_lamp_mm - centre).normalized();
  const Eigen::Vector3d away = to_lamp - to_camera.dot(to_lamp) * to_camera;
  const Eigen::Vector3d normal = (to_camera - 0.4 * away.normalized()).normalized();  // 22 degrees from the camera
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = Eigen::Vector3d::UnitZ().cross(normal).normalized();
  pose.linear().col(1) = normal.cross(pose.linear().col(0));
  pose.linear().col(2) = normal;
  pose.translation() = centre;
  plan.push_back(step(CalibrationRole::colour, 1,
                      {.object = rig::BenchObject::colour_chart, .pose = pose, .lamp = rig::Lamp::front}));
}

}  // namespace

std::vector<CalibrationStep> make_calibration_plan(const RigFile& rig) {
  std::vector<CalibrationStep> plan;
  add_lens_steps(rig, plan);
  add_platform_steps(plan);
  add_response_steps(rig, plan);
  add_panel_steps(rig, plan);
  add_chart_step(rig, plan);
  return plan;
}

}  // namespace station
