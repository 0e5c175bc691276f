// Tags that nothing should move (those on the table): where calibration saw them, and whether the camera, the table or
// one of the tags has moved since.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/tags.h"

namespace calibration {

using StillTags = std::map<int, std::array<Eigen::Vector2d, 4>>;  // the four corners of each id, px

// The median position of each corner of the layout's tags over the pictures that show it.
StillTags still_tags(const TagLayout& layout, const std::vector<TagObservation>& pictures);

struct Shift {
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();  // the common shift: median over the tags seen
  // The largest shift of a single tag against the common one. Tags whose shape has changed by half as much do not
  // count: they are partly in the shadow of the holder, which only moves what is found of their corners.
  double odd_px = 0.0;
  int odd_id = -1;  // that tag
  int tags = 0;     // number of tags seen
};

// The shift of the tags since `reference`; std::nullopt when fewer than two of them are seen.
std::optional<Shift> shift_of(const StillTags& reference, const TagObservation& seen);

// One line for people, in which `picture` names the picture, when a shift is beyond `limit_px`: the camera or the table
// was bumped, or one tag was moved.
std::optional<std::string> shift_problem(const Shift& shift, double limit_px, const std::string& picture);

}  // namespace calibration
