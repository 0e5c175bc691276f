// A thread file (kind "thread", thread.json): a digitized thread, its scattering parameters and where they come from;
// keys in fixtures/threads/README.md.
//
// Errors: those of reader.h; also refused is a lambda that is negative at some angle.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/scattering/thread.h"

namespace station {

struct ThreadFile {
  std::string name;
  double diameter_mm = 0.5;
  renderer::ThreadParameters parameters;
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major; for display only
  nlohmann::json fit = nlohmann::json::object();         // how well it agrees with its views; may be empty
  nlohmann::json provenance = nlohmann::json::object();  // session, software, date; may be empty
};

// The rules by which light leaves a thread, by the names that files give them.
const std::map<std::string, renderer::ThreadExit>& thread_exits();

ThreadFile parse_thread(const nlohmann::json& document, const std::string& source);
ThreadFile read_thread(const std::filesystem::path& file);
nlohmann::json to_json(const ThreadFile& thread);

}  // namespace station
