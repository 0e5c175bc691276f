// The scene of a flat cloth as pictures in cloth are made for: seen from in front, under even light.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace station {

// Makes the scene document; light has radiance 1 from everywhere, and names are relative to `folder`.
nlohmann::json flat_scene(const std::filesystem::path& thread, const std::filesystem::path& draft,
                          const Eigen::Vector2d& size_mm, const std::filesystem::path& folder);

}  // namespace station
