#include "renderer/trace/yarn_places.h"

#include <cmath>

namespace renderer {

YarnPlaces::YarnPlaces(const YarnPatch& patch, double margin_mm) : period_mm_(patch.period_x_mm, patch.period_y_mm) {
  for (const Yarn& yarn : patch.yarns) ++(yarn.warp ? ends_ : picks_);
  for (const RoundYarns& part : round_yarns_of(patch)) {
    for (const int thread : threads_of(part.patch)) {
      std::vector<SegmentOrigin> origins;
      cell_curves_of(part.patch, thread, margin_mm, &origins);
      std::vector<YarnPlace>& places = places_.emplace_back();
      for (const SegmentOrigin& origin : origins)
        places.push_back(place_of(part.numbers[static_cast<std::size_t>(origin.yarn)], origin.image));
    }
  }
}

void YarnPlaces::add(const std::vector<SegmentOrigin>& origins) {
  std::vector<YarnPlace>& places = places_.emplace_back();
  for (const SegmentOrigin& origin : origins) places.push_back(place_of(origin.yarn, origin.image));
}

YarnPlace YarnPlaces::place_of(int number, int image) const {
  const bool weft = number >= ends_;  // warp yarns come first
  return {.weft = weft, .number = weft ? number - ends_ + picks_ * image : number + ends_ * image};
}

YarnPlace YarnPlaces::at(std::size_t yarns, std::size_t segment, const Eigen::Vector3d& tile) const {
  YarnPlace place = places_[yarns][segment];
  const int axis = place.weft ? 1 : 0;
  place.number += (place.weft ? picks_ : ends_) * static_cast<int>(std::lround(tile[axis] / period_mm_[axis]));
  return place;
}

}  // namespace renderer
