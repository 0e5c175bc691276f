// All that a camera delivered in one run, also what was thrown away, so that a picture that comes twice is found out.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "rig/camera.h"
#include "station/capture/picture_record.h"

namespace station {

// By a quick hash of 64 bits, that of the standard library: it finds a camera's mistakes and is no proof of anything.
class DeliveredPictures {
 public:
  void add_test(const rig::Picture& test);

  // A picture for `step`, which counts as delivered from now on: what it is again ("picture of 'reflection-1'" of one
  // that is still taken, else a test or refused one of this run); nothing when it is new. Pictures of earlier runs are
  // known by their SHA-256 in `taken`, by step.
  std::optional<std::string> add(const rig::Picture& picture, const std::string& step,
                                 const std::map<std::string, PictureRecord>& taken);

 private:
  static std::size_t hash_of(const rig::Picture& picture);

  std::map<std::size_t, std::string> seen_;  // and for which step; empty: a test
  std::set<std::string> steps_;              // of this run
};

}  // namespace station
