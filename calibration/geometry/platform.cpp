#include "calibration/geometry/platform.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>
#include <stdexcept>

#include "calibration/geometry/platform_bundle.h"
#include "calibration/geometry/pose.h"
#include "calibration/geometry/rotation_vector.h"
#include "calibration/geometry/still_tags.h"
#include "calibration/sensor/degree.h"
#include "calibration/sensor/median.h"

namespace calibration {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

[[noreturn]] void refuse_platform(const std::string& found, const std::string& what_to_do) {
  throw std::runtime_error("platform calibration: " + found + ": " + what_to_do);
}

constexpr double kBump_px = 1.0;  // largest shift between calibration pictures; corners repeat to 0.1 px

// The direction of the axis in the camera frame, on the side of `up`: the mean of the rotation vectors from the first
// picture, in which larger turns weigh more.
Vector3d axis_direction(const std::vector<Isometry3d>& poses, const Vector3d& up) {
  Vector3d sum = Vector3d::Zero();
  double largest = 0.0;
  for (const Isometry3d& pose : poses) {
    const Vector3d turn = rotation_vector(pose.linear() * poses.front().linear().transpose());
    sum += turn.dot(up) < 0.0 ? Vector3d(-turn) : turn;
    largest = std::max(largest, turn.norm());
  }
  if (largest < 20.0 * kDegree) {
    refuse_platform(
        "the ring turns by " + std::to_string(std::lround(largest / kDegree)) + " degrees at most, 20 are needed",
        "check that the platform moves, and take pictures over a wider range");
  }
  const Vector3d axis = sum.normalized();
  if (axis.dot(up) < std::cos(30.0 * kDegree)) {
    refuse_platform("the axis and the table's normal differ by more than 30 degrees",
                    "lay the sheet with the table's tags flat on the table, facing up");
  }
  return axis;
}

// First guesses of the angles about `axis`, counted from the first picture; whole turns are taken from the readings.
std::vector<double> seed_angles(const std::vector<Isometry3d>& poses, const std::vector<PlatformPicture>& pictures,
                                const Vector3d& axis) {
  std::vector<double> angles;
  double agreement = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    angles.push_back(rotation_vector(poses[i].linear() * poses.front().linear().transpose()).dot(axis));
    agreement += std::sin(angles[i]) * std::sin(pictures[i].reading_rad - pictures.front().reading_rad);
  }
  const double sense = agreement < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double expected = sense * (pictures[i].reading_rad - pictures.front().reading_rad);
    angles[i] += 2.0 * std::numbers::pi * std::round((expected - angles[i]) / (2.0 * std::numbers::pi));
  }
  return angles;
}

// A point of the axis, which the turns A_i leave in place: (1 - A_i) c = p_i - A_i p_0.
Vector3d point_on_axis(const std::vector<Isometry3d>& poses, const std::vector<double>& angles, const Vector3d& axis) {
  Eigen::Matrix3d normal = axis * axis.transpose();  // picks one of the points along the axis, which all serve
  Vector3d right = axis * axis.dot(poses.front().translation());
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angles[i], axis).toRotationMatrix();
    const Eigen::Matrix3d m = Eigen::Matrix3d::Identity() - turn;
    normal += m.transpose() * m;
    right += m.transpose() * (poses[i].translation() - turn * poses.front().translation());
  }
  return normal.ldlt().solve(right);
}

// All tags of the table's sheet in one observation. No picture need show the whole sheet: as it does not move, its tags
// are gathered from all pictures.
TagObservation gathered(const StillTags& still) {
  TagObservation seen;
  for (const auto& [id, corners] : still) seen.push_back({.id = id, .corners_px = corners});
  return seen;
}

void refuse_odd_tags(const std::set<int>& odd, const std::string& layout) {
  if (odd.empty()) return;
  std::string ids;
  for (const int id : odd) ids += (ids.empty() ? "" : ", ") + std::to_string(id);
  refuse_platform("tags of the " + layout + " are not where the others want them: " + ids,
                  "they were moved, or stand in each other's places; put them right and take the pictures again");
}

Bundle seed(const Lens& lens, const PlatformTargets& targets, const std::vector<PlatformPicture>& pictures,
            const StillTags& still) {
  Bundle bundle;
  bundle.intrinsics = intrinsics_of(lens);
  bundle.sheet_height_mm = targets.table_height_mm;
  std::vector<Isometry3d> poses;
  std::set<int> odd;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::string name = "picture " + std::to_string(i + 1);
    const std::optional<PoseFit> ring = fit_pose(lens, targets.ring, pictures[i].seen);
    if (!ring)
      refuse_platform(name + " shows no tag of \"" + targets.ring.name + "\"",
                      "uncover the ring or leave the picture out");
    odd.insert(ring->odd_tags.begin(), ring->odd_tags.end());
    poses.push_back(ring->camera_from_object);
    bundle.turning.push_back(tagged_corners(targets.ring, pictures[i].seen));
    bundle.fixed.push_back(tagged_corners(targets.table, pictures[i].seen));
  }
  refuse_odd_tags(odd, "ring");
  const std::optional<PoseFit> sheet = fit_pose(lens, targets.table, gathered(still));
  if (!sheet || sheet->tags_used < 2)
    refuse_platform(
        std::to_string(sheet ? sheet->tags_used : 0) + " of the table's tags were seen, at least 2 are needed",
        "uncover the tags on the table");
  refuse_odd_tags({sheet->odd_tags.begin(), sheet->odd_tags.end()}, "table");
  const Vector3d up = sheet->camera_from_object.linear().col(2);
  const Vector3d on_table = sheet->camera_from_object.translation() - targets.table_height_mm * up;
  const Vector3d axis = axis_direction(poses, up);
  bundle.angles_rad = seed_angles(poses, pictures, axis);
  const Vector3d on_axis = point_on_axis(poses, bundle.angles_rad, axis);
  bundle.camera_from_axis = frame_with_world(axis, on_axis, up, on_table, Vector3d::Zero());
  const Isometry3d axis_from_camera = bundle.camera_from_axis.inverse();
  bundle.axis_from_ring = axis_from_camera * poses.front();
  bundle.axis_from_sheet = axis_from_camera * sheet->camera_from_object;
  return bundle;
}

// Fits the straight line of the angles over the readings and takes the offset out of the angles.
void fit_line(PlatformFit& fit) {
  const auto n = static_cast<double>(fit.readings_rad.size());
  double mean_reading = 0.0, mean_angle = 0.0, cross = 0.0, square = 0.0;
  for (std::size_t i = 0; i < fit.readings_rad.size(); ++i) {
    mean_reading += fit.readings_rad[i] / n;
    mean_angle += fit.angles_rad[i] / n;
  }
  for (std::size_t i = 0; i < fit.readings_rad.size(); ++i) {
    const double d = fit.readings_rad[i] - mean_reading;
    cross += d * (fit.angles_rad[i] - mean_angle);
    square += d * d;
  }
  fit.scale = cross / square;
  fit.offset_rad = mean_angle - fit.scale * mean_reading;
  double squares = 0.0;
  for (std::size_t i = 0; i < fit.readings_rad.size(); ++i) {
    fit.angles_rad[i] -= fit.offset_rad;
    squares += std::pow(fit.angles_rad[i] - fit.scale * fit.readings_rad[i], 2);
  }
  fit.angle_rms_rad = std::sqrt(squares / n);
}

void check(const PlatformTargets& targets, const std::vector<PlatformPicture>& pictures) {
  if (pictures.size() < 3) {
    refuse_platform(
        std::to_string(pictures.size()) + " pictures of the turning platform were given, at least 3 are needed",
        "take more angles");
  }
  if (!(targets.table_height_mm >= 0.0) || !std::isfinite(targets.table_height_mm)) {
    refuse_platform("the thickness of the sheet on the table is " + std::to_string(targets.table_height_mm) + " mm",
                    "measure it");
  }
  double smallest = pictures.front().reading_rad, largest = smallest;
  for (const PlatformPicture& picture : pictures) {
    if (!std::isfinite(picture.reading_rad))
      refuse_platform("a reading of the turntable is not a finite number", "check the turntable");
    smallest = std::min(smallest, picture.reading_rad);
    largest = std::max(largest, picture.reading_rad);
  }
  if (!(largest > smallest))
    refuse_platform("all readings of the turntable are equal", "take pictures at different angles");
}

void refuse_bumps(const StillTags& still, const std::vector<PlatformPicture>& pictures) {
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::optional<Shift> shift = shift_of(still, pictures[i].seen);
    if (!shift) continue;
    const auto problem = shift_problem(*shift, kBump_px, "picture " + std::to_string(i + 1));
    if (problem) throw std::runtime_error("platform calibration: " + *problem);
  }
}

// Refuses a tag that is a little off its place, which shows not in a single picture but over all of them.
void refuse_misplaced_tags(const AllErrors& errors) {
  std::vector<double> sizes;
  for (const auto& [id, tag] : errors.tags) sizes.push_back(tag.rms());
  const double typical_px = median(sizes);
  for (const auto& [id, tag] : errors.tags) {
    if (tag.rms() < std::max(0.5, 4.0 * typical_px)) continue;
    char text[120];
    std::snprintf(text, sizeof text, "tag %d stands %.2f px from its place in the layout (the others %.2f px)", id,
                  tag.rms(), typical_px);
    refuse_platform(text, "it was moved or glued on askew; print the sheet again or put the tag right");
  }
}

// The limits of the axis are two standard deviations, for an exact lens: as much as the thread's pictures can bear.
std::vector<Gate> gates_of(const PlatformFit& fit, std::size_t table_tags) {
  const Eigen::Vector4d sigma = fit.axis_covariance.diagonal().cwiseSqrt();
  return {at_most("platform: direction of the axis, 2 sigma, deg", 2.0 * sigma.head<2>().norm() / kDegree, 0.02,
                  "pictures at other angles turn with the axis; take more angles, or a larger ring"),
          at_most("platform: position of the axis, 2 sigma, mm", 2.0 * sigma.tail<2>().norm(), 0.1,
                  "threads are looked for where the axis puts them; take more angles, or a larger ring"),
          at_most("platform: corners, px rms", fit.rms_px, 0.5,
                  "prints lie flat and light is even when corners fit; press the prints flat, mind shadows"),
          at_most("platform: turntable, deg rms about a straight line", fit.angle_rms_rad / kDegree, 0.1,
                  "more is backlash or lost steps; see that the platform turns freely"),
          at_most("platform: axis against the table's normal, deg", fit.axis_to_table_normal_rad / kDegree, 2.0,
                  "a leaning turntable moves the spool in height; level it, lay the table's tags flat"),
          at_least("platform: tags on the table", static_cast<double>(table_tags), 3.0,
                   "fewer cannot tell a bumped camera from a moved tag; uncover them")};
}

}  // namespace

PlatformFit fit_platform(const Lens& lens, const PlatformTargets& targets,
                         const std::vector<PlatformPicture>& pictures) {
  check(targets, pictures);
  std::vector<TagObservation> seen;
  for (const PlatformPicture& picture : pictures) seen.push_back(picture.seen);
  const StillTags still = still_tags(targets.table, seen);
  refuse_bumps(still, pictures);
  Bundle bundle = seed(lens, targets, pictures, still);
  bool converged = true;
  for (int pass = 0; pass < 3; ++pass) {
    converged = solve(bundle);
    if (pass < 2) judge_corners(bundle);
  }
  const AllErrors errors = errors_of(bundle);
  PlatformFit fit;
  fit.rms_px = errors.used.rms();
  if (!std::isfinite(fit.rms_px)) refuse_platform("the fit went astray", "check the sizes and ids of the printed tags");
  refuse_misplaced_tags(errors);
  converged = take_covariance(bundle, fit.axis_covariance) && converged;
  const double unknowns = 6.0 + 4.0 + 6.0 + static_cast<double>(pictures.size()) - 1.0;
  fit.axis_covariance *= errors.used.squares / std::max(1.0, errors.used.count - unknowns);
  for (const Errors& picture : errors.pictures) fit.picture_rms_px.push_back(picture.rms());
  fit.converged = converged;
  fit.angles_rad = bundle.angles_rad;
  for (const PlatformPicture& picture : pictures) fit.readings_rad.push_back(picture.reading_rad);
  fit_line(fit);
  fit.world_from_camera = bundle.camera_from_axis.inverse();
  fit.world_from_table = bundle.axis_from_sheet;
  // The bundle counts angles from the first picture, the platform from reading 0.
  const double first_rad = fit.angles_rad.front();
  fit.world_from_ring = Eigen::AngleAxisd(-first_rad, Vector3d::UnitZ()) * bundle.axis_from_ring;
  fit.axis_to_table_normal_rad = std::acos(std::clamp(bundle.axis_from_sheet.linear()(2, 2), -1.0, 1.0));
  fit.gates = gates_of(fit, still.size());
  return fit;
}

}  // namespace calibration
