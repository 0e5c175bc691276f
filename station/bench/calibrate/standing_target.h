// A target that a hand has put on the platform with its stand: where it stands, as a picture shows it, and the angles
// of the platform at which it is seen as planned.
//
// All that is known of the camera then is its place by tape and the engraving of its lens; that is enough, because what
// counts is where in the picture the target lies and how its face is turned.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"
#include "station/bench/calibrate/calibration_step.h"
#include "station/documents/rig_file.h"

namespace station {

// True for steps of one role that are taken with the target put down once.
bool share_a_mounting(const CalibrationStep& a, const CalibrationStep& b);

// platform_from_object (mm; platform frame at angle 0 = world) of the board, the panel or the chart on a stand (from 1)
// that stands as asked.
Eigen::Isometry3d standing_pose(const RigFile& rig, rig::BenchObject object, int stand, bool on_its_side);

// How far the platform is turned either way while a target stands on it.
double platform_limit_rad(const RigFile& rig);

const calibration::TagLayout& target_tags(const RigFile& rig, rig::BenchObject object);
// The corners of its plate, in its frame (mm).
std::array<Eigen::Vector3d, 4> target_outline(const RigFile& rig, rig::BenchObject object);

// The turn about the vertical that brings `b` nearest to `a`, in radians.
double turn_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

// "3 cm too near and turned 20 degrees to the left": where it stands against where it should; empty: as it should.
std::string how_far_off(const rig::Arrangement& wanted, const Eigen::Isometry3d& standing);

// Where the target that was wanted stands, from its tags in a picture of `size` with the platform at `reading_rad`.
// Std::nullopt when none of them is seen.
std::optional<Eigen::Isometry3d> find_target(const RigFile& rig, const rig::Arrangement& wanted,
                                             const calibration::TagObservation& seen, cv::Size size,
                                             double reading_rad);

// The angles for the steps of `plan` from `first` on that have its role and arrangement, when their target stands as
// `standing` says; nothing when it cannot be seen as planned from there.
std::optional<std::vector<double>> angles_for(const RigFile& rig, const std::vector<CalibrationStep>& plan,
                                              std::size_t first, const Eigen::Isometry3d& standing);

// What a person shall put right, in whole sentences: where it stands (nothing: it was not seen) against where it
// should.
std::string how_to_stand(const rig::Arrangement& wanted, const std::optional<Eigen::Isometry3d>& standing);

}  // namespace station
