#include "station/bench/calibrate/standing_target.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/geometry/pose.h"
#include "calibration/geometry/target_stand.h"
#include "station/bench/calibrate/lamps.h"

namespace station {
namespace {

using calibration::turned;
using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

// Width and height of the plate; the board's goes on beyond its tags by half a gap.
Vector2d plate_mm(const RigFile& rig, rig::BenchObject object) {
  if (object == rig::BenchObject::colour_chart) return Vector2d::Constant(rig.colour_chart.value().plate_mm);
  if (object != rig::BenchObject::board) return Vector2d::Constant(rig.spectralon.plate_mm);
  Vector2d half = Vector2d::Zero();
  for (const calibration::Tag& tag : rig.board.tags)
    half =
        half.cwiseMax(tag.object_from_tag.translation().head<2>().cwiseAbs() + Vector2d::Constant(0.75 * tag.size_mm));
  return 2 * half;
}

int light_of(CalibrationRole role) {
  return role == CalibrationRole::front_light ? 0 : role == CalibrationRole::back_light ? 1 : -1;
}

}  // namespace

const calibration::TagLayout& target_tags(const RigFile& rig, rig::BenchObject object) {
  if (object == rig::BenchObject::board) return rig.board;
  if (object == rig::BenchObject::colour_chart) return rig.colour_chart.value().tags;
  return rig.spectralon.tags;
}

std::array<Vector3d, 4> target_outline(const RigFile& rig, rig::BenchObject object) {
  const Vector2d half = plate_mm(rig, object) / 2;
  return {
      Vector3d(-half.x(), -half.y(), 0), {half.x(), -half.y(), 0}, {half.x(), half.y(), 0}, {-half.x(), half.y(), 0}};
}

double turn_between(const Isometry3d& a, const Isometry3d& b) {
  const Eigen::Matrix3d between = a.linear() * b.linear().transpose();
  return std::atan2(between(1, 0) - between(0, 1), between(0, 0) + between(1, 1));
}

bool share_a_mounting(const CalibrationStep& a, const CalibrationStep& b) {
  return a.role == b.role && rig::same_arrangement(a.arrangement, b.arrangement);
}

Isometry3d standing_pose(const RigFile& rig, rig::BenchObject object, int stand, bool on_its_side) {
  const Vector2d plate = plate_mm(rig, object);
  Isometry3d pose =
      calibration::on_stand(calibration::kStandLeans_rad.at(static_cast<std::size_t>(stand - 1)),
                            on_its_side ? plate.x() : plate.y(), rig.spectralon.plate_mm, rig.platform_height_mm);
  if (on_its_side) pose.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()));
  return pose;
}

double platform_limit_rad(const RigFile& rig) {
  return std::min(std::numbers::pi, rig.turntable_wire ? rig.turntable_wire->stepper.limit_rad : std::numbers::pi);
}

std::optional<Isometry3d> find_target(const RigFile& rig, const rig::Arrangement& wanted,
                                      const calibration::TagObservation& seen, cv::Size size, double reading_rad) {
  const auto found = calibration::fit_pose(engraved_lens(rig, size), target_tags(rig, wanted.object), seen);
  if (!found) return std::nullopt;
  const Isometry3d world_from_object = rig.world_from_camera_by_tape * found->camera_from_object;
  // The distance is as good as the guessed focal length; that the target stands on its stand is known better.
  const Vector3d eye = rig.world_from_camera_by_tape.translation(), along = world_from_object.translation() - eye;
  const Vector3d place = eye + along * ((wanted.pose.translation().z() - eye.z()) / along.z());
  Isometry3d standing = turned(turn_between(world_from_object, wanted.pose), wanted.pose);
  standing.translation() = place;
  return turned(-reading_rad, standing);
}

std::optional<std::vector<double>> angles_for(const RigFile& rig, const std::vector<CalibrationStep>& plan,
                                              std::size_t first, const Isometry3d& standing) {
  const CalibrationStep& step = plan.at(first);
  const auto count = static_cast<int>(std::count_if(
      plan.begin(), plan.end(), [&](const CalibrationStep& other) { return share_a_mounting(step, other); }));
  const calibration::PanelBench bench = panel_bench(rig);
  const double limit = platform_limit_rad(rig);
  std::vector<double> angles;
  if (step.role == CalibrationRole::lens) {
    angles = calibration::plan_board_angles(bench.camera, rig.board, standing, count, limit);
  } else if (const int light = light_of(step.role); light >= 0) {
    std::vector<calibration::PanelPose> earlier;
    for (const CalibrationStep& other : plan) {
      if (share_a_mounting(step, other)) break;
      if (light_of(other.role) >= 0)
        earlier.push_back({light_of(other.role), turned(other.platform_angle_rad, other.arrangement.pose)});
    }
    const cv::Size size(bench.camera.lens.width_px, bench.camera.lens.height_px);
    angles = calibration::plan_panel_angles(bench, lamp_guesses(rig), earlier, light, standing, count, limit,
                                            light_options(rig, size));
  } else {
    angles.assign(static_cast<std::size_t>(count),
                  step.platform_angle_rad - turn_between(standing, step.arrangement.pose));
  }
  if (static_cast<int>(angles.size()) < count) return std::nullopt;
  return angles;
}

std::string how_far_off(const rig::Arrangement& wanted, const Isometry3d& standing) {
  const Vector3d off = standing.translation() - wanted.pose.translation();
  const long forward = std::lround(off.x() / 10), right = std::lround(off.y() / 10),
             turn = std::lround(turn_between(standing, wanted.pose) * 180 / std::numbers::pi);
  std::vector<std::string> wrong;
  if (forward != 0)
    wrong.push_back(std::to_string(std::abs(forward)) + " cm too " + (forward > 0 ? "near" : "far back"));
  if (right != 0)
    wrong.push_back(std::to_string(std::abs(right)) + " cm too far to the " + (right > 0 ? "right" : "left"));
  if (turn != 0)
    wrong.push_back("turned " + std::to_string(std::abs(turn)) + " degrees to the " + (turn > 0 ? "right" : "left"));
  std::string what;
  for (const std::string& part : wrong) what += (what.empty() ? "" : " and ") + part;
  return what;
}

std::string how_to_stand(const rig::Arrangement& wanted, const std::optional<Isometry3d>& standing) {
  const std::string name = rig::object_name(wanted.object);
  const std::string put = " Put stand " + std::to_string(wanted.stand) +
                          " in the middle of the platform, its face towards the camera" +
                          (wanted.room_light ? "." : ", and see that the flashlight is on.");
  if (!standing) return "None of the tags on " + name + " is in the picture." + put;
  const std::string off = how_far_off(wanted, *standing);
  return "The camera does not see enough of " + name + (off.empty() ? "" : ", " + off) + "." + put;
}

}  // namespace station
