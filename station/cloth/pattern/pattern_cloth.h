// A picture woven in a digitized thread: at each crossing only the thread's absorption is changed, and found so that
// the cloth shows the picture under even light [Xia 2025, section 6, figure 12].
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "station/output/progress.h"

namespace station {

struct PatternRequest {
  std::filesystem::path image;          // PNG, JPEG or linear EXR
  std::filesystem::path out;            // folder
  std::filesystem::path thread, draft;  // a flat cloth of these two ...
  std::filesystem::path scene{};        // ... or a cloth of this scene instead
  int cloth = 0;                        // number of the cloth in the scene
  int ends = 0;                         // crossings across the picture; 0: one per pixel
  double brightness = 1;                // factor of the picture's brightness
  bool within_gamut = true;             // its black to white becomes the darkest to brightest that the cloth can show
  int steps = 10;                       // steps of refinement; 0: only the curves of absorption
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// The colour error (CIEDE2000) of what the cloth shows, over crossings.
struct ColourError {
  double mean = 0, percentile_95 = 0;
};

struct Pattern {
  int ends = 0, picks = 0;             // crossings of the picture
  double width_mm = 0, height_mm = 0;  // size of the cloth that the picture takes
  double out_of_gamut = 0;             // share of the crossings that the picture as it is has out of gamut
  ColourError by_curves, refined;      // against what was asked for, within the gamut; 0 if all is out of it
  ColourError by_curves_of_picture, refined_of_picture;  // against the picture as it is, over all crossings
};

// Weaves the picture. Written into `out` are absorption.exr (sigma_a per thread radius, a texel per crossing),
// asked.exr (the reflectance asked of each crossing), scene.json (to render it), pattern.json (what is returned) and
// pattern.png: the picture, what is asked for, the cloth by the curves and refined, its colour errors, and the gamut
// (white: within). Ctrl-C stops it and leaves no files. Errors: std::runtime_error, one line: those of read_linear_srgb
// and scene_file.h; a folder that cannot be made; a picture of more than 16 million crossings; a cloth that is rendered
// by brute force; a cloth number that the scene does not have.
Pattern weave_pattern(const PatternRequest& request);

std::string describe(const Pattern& pattern);
nlohmann::json to_json(const Pattern& pattern);

}  // namespace station
