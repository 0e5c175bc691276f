// The pictures that a camera delivered in one run, thrown-away ones too, and what is wrong with a new one before it is
// read.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "rig/devices/camera.h"
#include "station/session/record/picture_record.h"
#include "station/session/record/verdict.h"

namespace station {

// Pictures are told apart by a quick hash of 64 bits, that of the standard library: it finds a camera's mistakes and is
// no proof of anything.
class DeliveredPictures {
 public:
  void add_test(const rig::Picture& test);

  // The picture was delivered for `asked`, and counts as delivered from now on. Findings, all bad: "file" when it is
  // empty, "settings" when it says others than were asked, "duplicate" when the camera delivered it before. Pictures of
  // earlier runs are known by their SHA-256 in `taken`, by step.
  Verdict check(const PictureRecord& asked, const rig::Picture& picture,
                const std::map<std::string, PictureRecord>& taken);

 private:
  static std::size_t hash_of(const rig::Picture& picture);
  // What the picture is again: "picture of 'reflection-1'" where that one is still taken, else a test or refused
  // picture of this run; nothing when it is new.
  std::optional<std::string> add(const rig::Picture& picture, const std::string& step,
                                 const std::map<std::string, PictureRecord>& taken);

  std::map<std::size_t, std::string> seen_;  // the step that each hash was delivered for; empty: a test
  std::set<std::string> steps_;              // of this run
};

}  // namespace station
