// The preview of cloth: a patch of one draft, woven of one digitized thread or of two, and two pictures of it, a swatch
// close up and a cylinder as in the paper. A session's is under its result/cloth, a design is a folder of its own. Each
// document there can be given to `weave` or `render` too.
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
  std::filesystem::path thread;         // thread or bundle file, of the warp
  std::filesystem::path weft_thread{};  // of the weft; empty: the warp's
  std::filesystem::path out;            // the cloth's folder
  bool with_threads = false;            // copies of the threads are put there, so that the folder stands alone
  std::filesystem::path draft;          // each system is scaled to its thread's diameter
  // The colours of warp and weft (cloth_colour.h); a system without one has its digitized thread's own.
  std::optional<Srgb8> warp_colour{}, weft_colour{};
  bool quick = false;  // smaller pictures
  ProgressStyle progress_style = ProgressStyle::automatic;
};

// Sets thread and folder: of a session's fitted `model`, "thread" or "bundle", with its own cloth folder where no other
// is asked for, or of a thread or bundle file, which needs `out`. Errors: std::runtime_error without it.
void weave_thread_of(ClothPreviewRequest& request, const std::filesystem::path& session_or_file,
                     const std::string& model);

// Writes draft.json, patch.json, made_of.json and, for each picture, its scene.json, .exr and .png, where a white card
// in the place of the cloth would be white; a coloured system's thread is written too. Ctrl-C stops it. Returns the
// content of made_of.json (session/results.h). Errors: those of the files read; std::runtime_error, one line, when a
// bundle is to be coloured or the threads' colours are those of different cameras.
nlohmann::json preview_cloth(const ClothPreviewRequest& request);

}  // namespace station
