// What the digitized thread weaves into: a patch of one draft and two pictures of it, a swatch close up and a cylinder as
// in the paper, under result/cloth of the session. Each file there is an input of `weave` or `render` too.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "station/embroider/embroider_motif.h"
#include "station/progress.h"

namespace station {

struct ClothPreviewRequest {
  std::filesystem::path session;  // with result/thread.json
  std::filesystem::path draft;    // scaled to the thread's diameter
  // Each system in its own colour (cloth_colour.h); the digitized thread's when left out.
  std::optional<Srgb8> warp_colour{}, weft_colour{};
  bool quick = false;             // smaller pictures
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Writes draft.json, patch.json, made_of.json and, for each picture, its scene.json, .exr and .png; of a coloured system its
// thread too. Ctrl-C stops it. Returns cloth_made_of.
nlohmann::json preview_cloth(const ClothPreviewRequest& request);

// {"draft", "warp", "weft": {"srgb": [r, g, b], "delta_e_2000": how far the thread's gamut is from it}, or null for the
// digitized thread's own colour}; null when there is no preview.
nlohmann::json cloth_made_of(const std::filesystem::path& session);

// The EXR pictures that are there, swatch first.
std::vector<std::filesystem::path> cloth_pictures(const std::filesystem::path& session);

}  // namespace station
