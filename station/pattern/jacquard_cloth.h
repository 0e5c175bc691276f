// A picture in two colours by structure alone, as jacquard looms weave it: which yarn lies on top at each crossing decides
// whether the warp's or the weft's colour is seen, and shaded satins (shaded_satin.h) make the tones between.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "renderer/weave/shaded_satin.h"
#include "station/progress.h"

namespace station {

struct JacquardRequest {
  std::filesystem::path image;  // PNG, JPEG or linear EXR
  std::filesystem::path out;    // folder
  std::filesystem::path warp_thread, weft_thread;
  std::filesystem::path draft;  // yarns and sett; its structure does not count
  int ends = 0;                 // across the picture; 0: one for each of its pixels
  double exposure = 1;          // the picture times this is shown
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct Jacquard {
  int ends = 0, picks = 0;
  double width_mm = 0, height_mm = 0;
  std::array<std::array<double, 3>, renderer::kShades> shades{};  // linear sRGB under even light, weft-faced first
  double delta_e_2000 =
      0;  // mean over squares of a satin's repeat, of the nearest mixture of the two against the picture
};

// Writes into `out`: draft.json, scene.json (to render it), jacquard.json (what is returned) and jacquard.png: the picture and what
// is shown of it. Each crossing has the shade nearest to the picture's tone, whose error goes to its neighbours (Floyd and Steinberg
// 1976); the picture's range of tones is brought to that of the satins. Ctrl-C stops it. Errors: std::runtime_error, one line: those of weave_pattern, of check_draft.
Jacquard weave_jacquard(const JacquardRequest& request);

std::string describe(const Jacquard& jacquard);
nlohmann::json to_json(const Jacquard& jacquard);

}  // namespace station
