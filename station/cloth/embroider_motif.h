// A motif embroidered in a digitized thread: each colour keeps all of the thread but its absorption [Xia 2025, section
// 6, figure 13], which is found where it is sewn, and is rendered on plain cloth under even light.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "station/documents/srgb.h"
#include "station/output/progress.h"

namespace station {

struct EmbroiderRequest {
  std::filesystem::path motif, thread, out;  // out: EXR (linear camera RGB) or PNG (display)
  std::vector<Srgb8> colours{};              // of the motif's threads, instead of the file's; fewer are repeated
  Srgb8 ground{236, 234, 228};               // the cloth's
  double diameter_mm = 0.4;                  // of the thread as it is sewn: 40 weight
  double pixels_per_mm = 12;                 // without a scene
  std::optional<int> samples_per_pixel{};    // 64, or the scene's
  std::filesystem::path scene{};  // sewn on a cloth of this scene instead, which is written beside `out` as .json
  int cloth = 0;                  // which of its cloths
  // Where in the patch of that cloth the motif's middle lies; else in the middle of the cloth.
  std::optional<Eigen::Vector2d> at_mm{};
  double turn_deg = 0;
  bool by_curve_only = false;  // absorptions as if each colour were alone
  std::uint64_t seed = 1;
  ProgressStyle progress_style = ProgressStyle::automatic;
};

struct EmbroideredThread {
  std::string name;
  Srgb8 wanted{};
  std::array<double, 3> sigma_a{};   // per thread radius, camera RGB
  double delta_e_2000 = 0;           // of what that absorption looks like, where it can be seen on the motif
  double by_curve_delta_e_2000 = 0;  // the same before its neighbours were looked at (motif_colours.h)
  bool out_of_gamut = false;         // no absorption has the colour on satin stitches
  int stitches = 0;
  double length_mm = 0;
};

struct Embroidery {
  std::string name;
  double width_mm = 0, height_mm = 0;
  std::vector<EmbroideredThread> threads;
  std::string image;
};

// Embroiders and renders the motif. With a scene, render_scene draws it, and the scene with the motif is written beside
// the picture, to be rendered again. Threads whose colour neither file nor request says keep the digitized thread's
// own. Ctrl-C stops it. Errors: std::runtime_error with one line: those of motif_file.h, thread_file.h, stitch_curves.h
// and picture_destination.h, those of render_scene, a picture of more than 100 million pixels.
Embroidery embroider(const EmbroiderRequest& request);

std::string describe(const Embroidery& embroidery);
nlohmann::json to_json(const Embroidery& embroidery);

}  // namespace station
