// What decides the pixels of a rendering: two renderings of the same identity give the same picture bit for bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace station {

struct RenderIdentity {
  std::string scene_sha256;  // of the scene file and of every file that it names
  std::string software;
  std::uint64_t seed = 1;
  int samples_per_pixel = 0;
  double noise = 0;  // the noise at which it ends earlier; 0: none
};

// The SHA-256 over the scene file and the files that its texts name, relative to its folder, and so on in the documents
// (.json, .gltf) among them. Errors: std::runtime_error that names a file which cannot be read.
std::string sha256_of_scene(const std::filesystem::path& scene);

// Those files, the scene's own first.
std::vector<std::filesystem::path> files_of_scene(const std::filesystem::path& scene);

nlohmann::json to_json(const RenderIdentity& identity);

// What distinguishes another rendering, such as "seed 3, not 4"; nothing when it is the same.
std::optional<std::string> difference(const nlohmann::json& other, const RenderIdentity& identity);

}  // namespace station
