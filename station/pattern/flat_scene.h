// A scene of a flat cloth, seen as pictures in cloth are made: from in front, under even light.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace station {

// Light is 1 from everywhere; names are relative to `folder`.
nlohmann::json flat_scene(const std::filesystem::path& thread, const std::filesystem::path& draft,
                          const Eigen::Vector2d& size_mm, const std::filesystem::path& folder);

}  // namespace station
