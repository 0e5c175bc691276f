// The names of files in scene documents (scene_file.h), which are relative to a folder.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace station {

// The name of `file` relative to `folder`.
std::string name_from(const std::filesystem::path& folder, const std::filesystem::path& file);

// A scene whose names are relative to `from`, with names relative to `to`.
nlohmann::json moved_scene(nlohmann::json scene, const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace station
