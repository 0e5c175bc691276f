// What decides the pixels of a rendering: two renderings of the same identity give the same picture bit for bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace station {

struct RenderIdentity {
  std::string scene_sha256;  // of the scene file and of every file that it names
  std::string software;
  std::uint64_t seed = 1;
  int samples_per_pixel = 0;
  double noise = 0;  // that ends it earlier; 0: none
};

// Files are those whose names stand in the scene's document as texts, relative to its folder, and in the documents
// (.json, .gltf) that it names. Errors: std::runtime_error that names a file which cannot be read.
std::string sha256_of_scene(const std::filesystem::path& scene);

nlohmann::json to_json(const RenderIdentity& identity);

// What distinguishes another rendering, as "seed 3, not 4"; none when it is the same.
std::optional<std::string> difference(const nlohmann::json& other, const RenderIdentity& identity);

}  // namespace station
