// What a rig file lacks, in sentences, without touching a device. The work of `threadstation rig check`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace station {

struct RigRemark {
  bool must_be_mended = false;  // otherwise: good to know
  std::string sentence;
};

// All remarks, not the first alone: a key that is missing or wrong is taken from a ready rig file of its kind, so that
// the rest can be looked at. Empty for a file that leaves nothing to say.
std::vector<RigRemark> review_rig(const std::filesystem::path& file);

}  // namespace station
