// Tags that nothing should move (those on the table): where they were seen at calibration, and whether the camera, the
// table or one of them has moved since.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/tags.h"

namespace calibration {

using StillTags = std::map<int, std::array<Eigen::Vector2d, 4>>;  // by id: corners, px

// Median position of each corner of the layout's tags over the views that show it.
StillTags still_tags(const TagLayout& layout, const std::vector<TagObservation>& views);

struct Shift {
  Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();  // median over the tags seen: what all did together
  double odd_px = 0.0;                                // how far the tag that moved most by itself moved
  int odd_id = -1;
  int tags = 0;
};

// std::nullopt when fewer than two of the tags are seen.
std::optional<Shift> shift_of(const StillTags& reference, const TagObservation& seen);

// One clear line when the shift is beyond `limit_px`: the camera or the table was bumped, or one tag was moved.
// `picture` names the picture in it.
std::optional<std::string> shift_problem(const Shift& shift, double limit_px, const std::string& picture);

}  // namespace calibration
