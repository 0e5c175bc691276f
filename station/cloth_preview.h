// What the digitized thread weaves into: a patch of one draft and two pictures of it, a swatch close up and a cylinder as
// in the paper, under result/cloth of the session. Each file there is an input of `weave` or `render` too.
#pragma once

#include <filesystem>
#include <vector>

#include "station/progress.h"

namespace station {

struct ClothPreviewRequest {
  std::filesystem::path session;  // with result/thread.json
  std::filesystem::path draft;    // scaled to the thread's diameter
  bool quick = false;             // smaller pictures
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Writes draft.json, patch.json and, for each picture, its scene.json, .exr and .png. Ctrl-C stops it.
void preview_cloth(const ClothPreviewRequest& request);

// The EXR pictures that are there, swatch first.
std::vector<std::filesystem::path> cloth_pictures(const std::filesystem::path& session);

}  // namespace station
