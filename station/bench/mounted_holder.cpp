#include "station/bench/mounted_holder.h"

#include <numbers>
#include <stdexcept>

#include "calibration/geometry/pose.h"
#include "station/bench/bench_reading.h"

namespace station {
namespace {

void require_tags(const PosePicture& picture, const calibration::TagLayout& holder) {
  const long count = tags_of_holder(picture, holder);
  if (count < kFewestHolderTags)
    throw std::runtime_error("step " + picture.step + ": " + std::to_string(count) +
                             " of the holder's tags were found, " + std::to_string(kFewestHolderTags) +
                             " are needed; uncover the tags and take the picture again");
}

}  // namespace

Eigen::Isometry3d nominal_holder_pose(const RigFile& rig, const inversion::WrappedSpool& spool,
                                      rig::Mounting mounting) {
  const bool vertical = mounting == rig::Mounting::vertical;
  const double half_height_mm = (vertical ? spool.frame_width_mm : spool.frame_height_mm) / 2;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = rig.platform_height_mm + half_height_mm;
  if (vertical) pose.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  return pose;
}

Eigen::Isometry3d nominal_pose(const RigFile& rig, const Spool& spool, rig::Mounting mounting) {
  if (!spool.fabric) return nominal_holder_pose(rig, spool.wrapping, mounting);
  return Eigen::Isometry3d(Eigen::Translation3d(0, 0, rig.platform_height_mm));
}

long tags_of_holder(const PosePicture& picture, const calibration::TagLayout& holder) {
  return calibration::tags_seen(holder, picture.seen);
}

bool shows_holder(const PosePicture& picture, const calibration::TagLayout& holder) {
  return tags_of_holder(picture, holder) >= kFewestHolderTags;
}

MountedHolder measure_holder(const std::vector<PosePicture>& pictures, const RigCalibration& calibration,
                             const RigFile& rig) {
  std::vector<calibration::Sighting> sightings;
  for (const PosePicture& picture : pictures) {
    require_tags(picture, rig.holder_tags);
    const BenchReading bench = read_bench(calibration, rig, picture.seen);
    require_calibrated_bench(calibration, bench, picture.reading_rad, "step " + picture.step);
    const double angle_rad = bench.angle ? bench.angle->angle_rad : calibration.platform.scale * picture.reading_rad;
    const Eigen::AngleAxisd turned(angle_rad, Eigen::Vector3d::UnitZ());
    sightings.push_back({calibration.platform.world_from_camera.inverse() * turned, picture.seen});
  }
  const auto fit = calibration::fit_mounted_pose(calibration.lens.lens, rig.holder_tags, sightings);
  if (!fit) throw std::runtime_error("the holder's tags give no pose; uncover them and take the pose pictures again");
  if (!fit->odd_tags.empty())
    throw std::runtime_error("step " + pictures.front().step + ": tag " + std::to_string(fit->odd_tags.front()) +
                             " of the holder is not where the others want it; put it right, or mount the holder so "
                             "that it does not move between the pose pictures");
  return {.platform_from_holder = fit->platform_from_object, .rms_px = fit->rms_px};
}

}  // namespace station
