// A scene file to a picture on disk: the work behind `threadstation render`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "station/cloth/render/ranks.h"
#include "station/cloth/render/render_memory.h"
#include "station/output/progress.h"

namespace station {

struct RenderRequest {
  std::filesystem::path scene, out;
  // The scene's own when left out; with a noise to reach at most this, and kMostSamples when left out.
  std::optional<int> samples_per_pixel;
  double noise = 0;  // relative error to reach in each tile (renderer/picture/film.h); 0: all samples everywhere
  std::uint64_t seed = 1;
  int threads = 0;                    // 0 = all cores
  std::optional<double> brightness;   // PNG only; the scene's own when left out, then the picture's 99th percentile
  bool layers = false, half = false;  // EXR only: more channels (render/render_channels.h), colours in 16 bit
  bool denoise = false;               // also a picture without noise, to look at (denoised_of())
  bool png = false;                   // a display picture beside the EXR, a.exr -> a.png
  bool keep_finished = false;         // nothing is done where `out` is this very rendering already
  bool fresh = false;                 // a checkpoint that is there is thrown away
  bool only_this = false;             // likewise, if it cannot be gone on from: its rendering is not wanted any more
  double checkpoint_every_s = 300;
  ProgressStyle progress = ProgressStyle::automatic;
  std::string task = "render";  // for the progress
};

inline constexpr int kMostSamples = 4096;

struct RenderReport {
  std::string image;
  bool kept = false;  // it was there
  int width = 0, height = 0, samples_per_pixel = 0;
  double build_s = 0, render_s = 0;
  std::uint64_t samples = 0, rays = 0;  // of this run
  std::uint64_t samples_before = 0;     // of the checkpoint that it went on from
  double brightness = 1;
  double noise = 0;  // relative error of a pixel, root mean square over the tiles
  RenderMemory memory;
  double noisy = 0;  // share of the tiles that have more than the noise asked for
};

// Writes EXR (linear camera RGB, radiance) or PNG (display), by the ending of `out`. Now and then, and when ctrl-C
// stops it, it leaves a checkpoint (render/checkpoint.h) and a preview beside `out`; asked for the same again it goes
// on from there and ends with the picture that it would have made in one go, bit for bit. Both go away when the picture
// is done. `cloths`: the scene's, where they have been built already; otherwise they are built here. Errors:
// std::runtime_error with one line: a bad scene (scene_file.h, build_scene.h), an ending that is neither, a file that
// cannot be written, another rendering's checkpoint, stopped.
RenderReport render_scene(const RenderRequest& request, std::vector<BuiltCloth> cloths = {});
// The same by several processes; the first reports and writes the picture, the others report nothing of use.
RenderReport render_scene(const RenderRequest& request, RenderRanks& ranks, std::vector<BuiltCloth> cloths = {});

// Whether the picture is there already and render_scene would keep it.
bool is_kept(const RenderRequest& request, const SceneFile& scene);

// "1%" or "0.01": a relative error from 0.01 % to 100 %; none for anything else.
std::optional<double> parse_noise(const std::string& text);

// a.exr -> a.denoised.exr
std::filesystem::path denoised_of(const std::filesystem::path& picture);

// a.exr -> a.preview.png
std::filesystem::path preview_of(const std::filesystem::path& picture);

nlohmann::json to_json(const RenderReport& report);
std::string describe_times(const RenderReport& report);
std::string describe_noise(const RenderReport& report);

}  // namespace station
