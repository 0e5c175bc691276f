// What the rig's camera sees now, frame after frame, for whoever looks at a file: the work behind `threadstation preview`.
#pragma once

#include <filesystem>

#include "station/documents/rig_file.h"
#include "station/progress.h"

namespace station {

struct LiveViewRequest {
  std::filesystem::path rig, out;  // out: JPEG, replaced by each frame in one piece
  int frames = 600;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Ends after so many frames or at ctrl-C; returns how many there were. A simulated bench stands empty in the room's light.
// Errors: std::runtime_error of the camera, and of a file that cannot be written.
int live_view(const LiveViewRequest& request);

}  // namespace station
