// The preview of cloth: a patch of one draft, woven of one digitized thread or of two, and pictures of it, of a swatch
// close up and a cylinder as in the paper, or of others. A session's is under its result/cloth, a design is a folder of
// its own. Each document there can be given to `weave` or `render` too.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "station/cloth/preview/cloth_stage.h"
#include "station/cloth/preview/woven_threads.h"

namespace station {

struct ClothPreviewRequest {
  ThreadsToWeave cloth;
  std::vector<std::string> shapes{"swatch", "cylinder"};  // of cloth_shapes(), or mesh files (renderer::read_mesh)
  std::optional<double> mesh_unit_mm{};                   // of the meshes; nothing: glTF's metres, others' millimetres
  std::string lights = "studio";                          // of cloth_lights(), or a picture of surroundings (EXR)
  ClothView view{};
  int size_px = 0;     // the longer side of each picture; 0: as a screen shows it
  bool quick = false;  // smaller pictures of fewer samples
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Sets thread and folder: of a session's fitted `model`, "thread" or "bundle", with its own cloth folder where no other
// is asked for, or of a thread or bundle file, which needs `out`. Errors: std::runtime_error without it.
void weave_thread_of(ThreadsToWeave& wanted, const std::filesystem::path& session_or_file, const std::string& model);

// Writes what weave_threads writes, made_of.json and, for each picture, its scene.json, .exr and .png, where a white
// card in the place of the cloth (white_card of the stage's scene) would be white before view and light are turned.
// What is there already of the same is kept, so that the same again goes on after ctrl-C. Returns the content of
// made_of.json (session/results.h). Errors: those of the files read and of weave_threads; std::runtime_error, one line,
// for a size that no picture has.
nlohmann::json preview_cloth(const ClothPreviewRequest& request);

}  // namespace station
