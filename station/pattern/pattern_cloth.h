// A picture in cloth of a digitized thread: each crossing of the weave keeps all of the thread but its absorption, which is
// found so that the cloth shows the picture under even light [Xia 2025, section 6, figure 12].
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "station/progress.h"

namespace station {

struct PatternRequest {
  std::filesystem::path image;          // PNG, JPEG or linear EXR
  std::filesystem::path out;            // folder
  std::filesystem::path thread, draft;  // a flat cloth of them ...
  std::filesystem::path scene{};        // ... or a cloth of this scene instead
  int cloth = 0;                        // which of its cloths
  int ends = 0;                         // crossings across the picture; 0: one for each of its pixels
  double exposure = 1;                  // the picture times this is shown
  bool within_gamut = true;  // its black to white is brought to the darkest and brightest that the cloth can show
  int steps = 10;            // of refinement; 0: the curves alone
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// CIEDE2000 of what the cloth shows against the picture, over crossings.
struct ColourError {
  double mean = 0, percentile_95 = 0;
};

struct Pattern {
  int ends = 0, picks = 0;             // crossings of the picture
  double width_mm = 0, height_mm = 0;  // of the cloth that it takes
  double out_of_gamut = 0;             // share of the crossings, of the picture as it is
  ColourError by_curves, refined;      // against what was asked for, within the gamut; 0 where that is nothing
  ColourError by_curves_of_picture, refined_of_picture;  // against the picture as it is, everywhere
};

// Writes into `out`: absorption.exr (sigma_a per thread radius, a texel per crossing), asked.exr (what they are to reflect), scene.json (to render it), pattern.json
// (what is returned) and pattern.png: the picture, what is asked for, the cloth by the curves and refined, its colour errors, and the gamut
// (white: within). Ctrl-C stops it and leaves no files. Errors: std::runtime_error, one line: those of read_linear_srgb and scene_file.h; a
// folder that cannot be made; a picture of more than 16 million crossings; cloth by brute force; no such cloth.
Pattern weave_pattern(const PatternRequest& request);

std::string describe(const Pattern& pattern);
nlohmann::json to_json(const Pattern& pattern);

}  // namespace station
