// What the rig's camera sees now, frame after frame, in a file for whoever looks at it: the work of `threadstation
// preview`.
#pragma once

#include <filesystem>

#include "rig/people/asked_person.h"
#include "station/documents/rig_file.h"
#include "station/output/progress.h"

namespace station {

struct LiveViewRequest {
  std::filesystem::path rig, out;  // out: JPEG, replaced by each frame in one piece
  int frames = 600;
  rig::AskedPerson* asked = nullptr;  // none: refused when the rig needs a person
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Writes frames until there are as many as asked or until ctrl-C, and returns how many there were. A simulated bench
// stands empty in the room's light. Errors: std::runtime_error of the camera, and of a file that cannot be written.
int live_view(const LiveViewRequest& request);

}  // namespace station
