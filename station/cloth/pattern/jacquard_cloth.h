// A picture woven in two colours by structure alone, as jacquard looms weave it: which yarn lies on top at each
// crossing decides whether the warp's or the weft's colour is seen, and shaded satins (shaded_satin.h) make the tones
// between.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "renderer/weave/shaded_satin.h"
#include "station/output/progress.h"

namespace station {

struct JacquardRequest {
  std::filesystem::path image;  // PNG, JPEG or linear EXR
  std::filesystem::path out;    // folder
  std::filesystem::path warp_thread, weft_thread;
  std::filesystem::path draft;  // gives yarns and sett; its structure is not used
  int ends = 0;                 // across the picture; 0: one per pixel
  double brightness = 1;        // factor of the picture's brightness
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct Jacquard {
  int ends = 0, picks = 0;
  double width_mm = 0, height_mm = 0;
  std::array<std::array<double, 3>, renderer::kShades> shades{};  // linear sRGB under even light, weft-faced first
  // Mean over squares of a satin's repeat, of the nearest mixture of the two against the picture.
  double delta_e_2000 = 0;
};

// Weaves the picture. Written into `out` are draft.json, scene.json (to render it), jacquard.json (what is returned)
// and jacquard.png: the picture beside what the cloth shows of it. The picture's range of tones is brought to that of
// the satins; each crossing then has the shade nearest to its tone, and the error goes to its neighbours (Floyd and
// Steinberg 1976). Ctrl-C stops it. Errors: std::runtime_error, one line: those of weave_pattern and of check_draft.
Jacquard weave_jacquard(const JacquardRequest& request);

std::string describe(const Jacquard& jacquard);
nlohmann::json to_json(const Jacquard& jacquard);

}  // namespace station
