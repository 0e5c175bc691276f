// Digitized threads woven into a patch of one draft: what every picture of their cloth begins with.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "station/documents/srgb.h"
#include "station/output/progress.h"

namespace station {

struct ThreadsToWeave {
  std::filesystem::path thread;         // thread or bundle file, of the warp
  std::filesystem::path weft_thread{};  // of the weft; empty: the warp's
  std::filesystem::path out;            // the cloth's folder
  bool with_threads = false;            // copies of the threads are put there, so that the folder stands alone
  std::filesystem::path draft;          // each system is scaled to its thread's diameter
  // The colours of warp and weft (cloth_colour.h); a system without one has its digitized thread's own.
  std::optional<Srgb8> warp_colour{}, weft_colour{};
  std::string fibers{};  // what is seen of them close by, one of fiber_kinds(); empty: nothing
  bool uneven = false;   // as the threads were measured to be (uneven_threads.h)
};

struct WovenThreads {
  std::vector<std::string> files;                 // the patch's threads in order, as a scene in the folder names them
  nlohmann::json made_of;                         // session/results.h, without what pictures add
  std::array<double, 9> linear_srgb_from_camera;  // the warp's
  std::string fibers{};                           // as they were asked for
};

// Writes draft.json, patch.json, drawing.svg (the draft in the threads' colours), and the threads that are coloured or
// to be copied. Errors: those of the files read and of weave_watched; std::runtime_error, one line, when a bundle is to
// be coloured or uneven, a thread's irregularity was not measured, the threads' colours are those of different cameras,
// or the folder cannot be made.
WovenThreads weave_threads(const ThreadsToWeave& wanted, ProgressStyle progress_style);

}  // namespace station
