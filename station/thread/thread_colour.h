// The colour of a digitized thread, as people name it and look for it.
#pragma once

#include <Eigen/Core>

#include "station/documents/thread_file.h"

namespace station {

struct ThreadColour {
  Eigen::Vector3d linear_srgb;
  Eigen::Vector3d lab;  // CIE 1976, D50
  // The mean of the photographs with light from the front over a white card in the same light; otherwise, where none is
  // known, the albedo under light from all sides.
  bool photographed = false;
};

ThreadColour colour_of(const ThreadFile& thread);

}  // namespace station
