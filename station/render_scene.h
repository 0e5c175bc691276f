// A scene file to a picture on disk: the work behind `threadstation render`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "station/progress.h"

namespace station {

struct RenderRequest {
  std::filesystem::path scene, out;
  std::optional<int> samples_per_pixel;  // the scene's own when left out
  std::uint64_t seed = 1;
  int threads = 0;                 // 0 = all cores
  std::optional<double> exposure;  // PNG only; the scene's own when left out, then the picture's 99th percentile
  ProgressStyle progress = ProgressStyle::automatic;
};

struct RenderReport {
  std::string image;
  int width = 0, height = 0, samples_per_pixel = 0;
  double build_s = 0, render_s = 0;
  std::uint64_t samples = 0, rays = 0;
  double exposure = 1;
};

// Writes EXR (linear camera RGB, radiance) or PNG (display), by the ending of `out`. Ctrl-C stops it.
// Errors: std::runtime_error with one line: a bad scene (scene_file.h), an ending that is neither, a file that cannot be
// written, stopped.
RenderReport render_scene(const RenderRequest& request);

nlohmann::json to_json(const RenderReport& report);
std::string describe_times(const RenderReport& report);

}  // namespace station
