// The rig file of a new bench: from a ready one that is like it, from what a person says, and from looking at the
// platform while it turns. The work of `threadstation rig new`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig/people/asked_person.h"
#include "station/output/progress.h"

namespace station {

struct NewRigRequest {
  std::filesystem::path out;   // a file that is not there yet
  std::filesystem::path like;  // a rig file; empty: the person is asked what turns the platform
  rig::AskedPerson* asked = nullptr;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// What was measured is written into the file, and what a person should know of it is returned in sentences. What was
// answered lies in <out>.draft until the file is written, so that an interrupted interview goes on. Errors:
// std::runtime_error of the devices; when the platform turns the wrong way, or its tags are not seen; rig::Declined.
std::vector<std::string> make_rig(const NewRigRequest& request);

}  // namespace station
