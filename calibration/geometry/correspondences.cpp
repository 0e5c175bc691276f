#include "calibration/geometry/correspondences.h"

#include <map>
#include <stdexcept>

namespace calibration {

std::vector<Corner> match_corners(const TagLayout& layout, const TagObservation& seen) {
  std::map<int, const Tag*> known;
  for (const Tag& tag : layout.tags) known[tag.id] = &tag;
  std::vector<Corner> corners;
  for (const TagDetection& detection : seen) {
    const auto tag = known.find(detection.id);
    if (tag == known.end()) continue;
    const auto points = corners_in_object(*tag->second);
    for (std::size_t c = 0; c < 4; ++c) {
      if (!detection.corners_px[c].allFinite() || !points[c].allFinite()) {
        throw std::runtime_error("\"" + layout.name + "\": a corner of tag " + std::to_string(detection.id) +
                                 " is not a finite number: leave this picture out");
      }
      corners.push_back({points[c], detection.corners_px[c]});
    }
  }
  return corners;
}

}  // namespace calibration
