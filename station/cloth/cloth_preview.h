// The preview of a digitized thread's cloth, under result/cloth of the session: a patch of one draft and two pictures
// of it, a swatch close up and a cylinder as in the paper. Each document there can be given to `weave` or `render` too.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "station/documents/srgb.h"
#include "station/output/progress.h"

namespace station {

struct ClothPreviewRequest {
  std::filesystem::path session;  // with the fitted model
  std::filesystem::path draft;    // scaled to the thread's diameter
  std::string model = "thread";   // or "bundle"
  // The colours of warp and weft (cloth_colour.h); a system without one has the digitized thread's own.
  std::optional<Srgb8> warp_colour{}, weft_colour{};
  bool quick = false;  // smaller pictures
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Writes draft.json, patch.json, made_of.json and, for each picture, its scene.json, .exr and .png; a coloured system's
// thread is written too. Ctrl-C stops it. Returns the content of made_of.json. Errors: those of the files read;
// std::runtime_error, one line, when a bundle is to be coloured.
nlohmann::json preview_cloth(const ClothPreviewRequest& request);

}  // namespace station
