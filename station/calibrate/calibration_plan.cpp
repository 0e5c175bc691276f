#include "station/calibrate/calibration_plan.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "station/calibrate/response_plan.h"

namespace station {
namespace {

constexpr double kRadPerDeg = M_PI / 180.0;
constexpr std::array<const char*, 9> kRoleWords{"lens",     "turning", "flat", "front_light", "back_light",
                                                "response", "rapid",   "dark", "white_field"};

Eigen::Matrix3d turn(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(degrees * kRadPerDeg, axis).toRotationMatrix();
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

void add_platform_steps(const RigFile& rig, std::vector<CalibrationStep>& plan) {
  double half_height_mm = 0;
  for (const calibration::Tag& tag : rig.board.tags)
    half_height_mm = std::max(half_height_mm, std::abs(tag.object_from_tag.translation().y()) + tag.size_mm * 0.75);
  Eigen::Isometry3d standing = Eigen::Isometry3d::Identity();  // faces +x
  standing.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  standing.translation().z() = rig.platform_height_mm + half_height_mm;
  int number = 0;
  for (int angle_deg = -60; angle_deg <= 60; angle_deg += 15) {
    CalibrationStep turning =
        step(CalibrationRole::turning, ++number,
             {.object = rig::BenchObject::board, .on_platform = true, .pose = standing, .room_light = true});
    turning.platform_angle_rad = angle_deg * kRadPerDeg;
    plan.push_back(turning);
  }
  number = 0;
  for (const double away_mm : {20.0, 45.0}) {
    Eigen::Isometry3d lying = Eigen::Isometry3d::Identity();  // face up, its top away from the camera
    lying.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    lying.translation() = Eigen::Vector3d(-away_mm, 0, rig.platform_height_mm + rig.board_thickness_mm);
    plan.push_back(step(CalibrationRole::flat, ++number,
                        {.object = rig::BenchObject::board, .on_platform = true, .pose = lying, .room_light = true}));
  }
}

// The Spectralon panel in the hand: direction of its normal, position of its centre.
struct PanelPose {
  double azimuth_deg, elevation_deg;
  Eigen::Vector3d centre_mm;
};

void add_panel_steps(CalibrationRole role, rig::Lamp lamp, const std::vector<PanelPose>& poses,
                     std::vector<CalibrationStep>& plan) {
  int number = 0;
  for (const PanelPose& panel : poses) {
    const double azimuth = panel.azimuth_deg * kRadPerDeg, elevation = panel.elevation_deg * kRadPerDeg;
    const Eigen::Vector3d normal(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                 std::sin(elevation));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d right = Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 0);
    pose.linear().col(0) = right;
    pose.linear().col(1) = normal.cross(right);
    pose.linear().col(2) = normal;
    pose.translation() = panel.centre_mm;
    plan.push_back(step(role, ++number, {.object = rig::BenchObject::spectralon, .pose = pose, .lamp = lamp}));
  }
}

}  // namespace

std::string to_text(CalibrationRole role) {
  return kRoleWords.at(static_cast<std::size_t>(role));
}

CalibrationRole calibration_role(const std::string& text) {
  for (std::size_t i = 0; i < kRoleWords.size(); ++i)
    if (text == kRoleWords[i]) return static_cast<CalibrationRole>(i);
  throw std::runtime_error("unknown calibration role \"" + text + "\"");
}

std::vector<CalibrationStep> make_calibration_plan(const RigFile& rig) {
  std::vector<CalibrationStep> plan;
  add_lens_steps(rig, plan);
  add_platform_steps(rig, plan);
  add_response_steps(rig, plan);
  // High enough that no tilted plate dips into the platform or its shadow.
  const double z = rig.platform_height_mm + rig.spectralon.plate_mm / 2 + 2;
  // Tilts about both axes, two depths and the picture's corners: they separate position, intensity and vignetting.
  add_panel_steps(CalibrationRole::front_light, rig::Lamp::front,
                  {{15, 35, {0, 0, z - 4}},
                   {-25, 25, {0, 10, z}},
                   {50, 25, {0, -10, z}},
                   {15, 65, {0, 0, z - 10}},
                   {15, 8, {20, 0, z + 4}},
                   {-15, 55, {50, 15, z}},
                   {45, 55, {-30, -15, z}},
                   {15, 35, {60, -25, z + 10}},
                   {15, 35, {-40, 25, z}},
                   {0, 40, {70, -38, z}},
                   {0, 40, {70, 38, z}},
                   {30, 40, {-10, 36, z + 4}}},
                  plan);
  // Behind, one face must be seen by the camera and lit from the back: the panel lies nearly flat.
  add_panel_steps(CalibrationRole::back_light, rig::Lamp::back,
                  {{0, 80, {0, 0, z - 10}},
                   {90, 72, {0, 0, z - 10}},
                   {-90, 74, {0, 0, z - 15}},
                   {180, 88, {15, 0, z - 5}},
                   {0, 84, {-40, 20, z - 30}},
                   {45, 76, {35, -20, z}},
                   {-45, 76, {0, 25, z - 5}},
                   {0, 82, {20, -25, z - 25}}},
                  plan);
  return plan;
}

}  // namespace station
