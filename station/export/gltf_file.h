// A square swatch of cloth as glTF 2.0: cloth.gltf, cloth.bin and five PNG files.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "station/export/gltf_brdf.h"
#include "station/export/pbr_maps.h"

namespace station {

inline constexpr double kGltfSwatch_mm = 100;  // its side; facing +z, the warp along +y

struct GltfSwatch {
  std::string name;
  double period_x_mm = 1, period_y_mm = 1;  // of the maps' picture
  const PbrMaps& maps;                      // of the face; the back shows them too
  GltfMaterial material;
  nlohmann::json extras = nlohmann::json::object();  // of the material, for people
};

// Metres, as glTF has them. Errors: std::runtime_error, one line, when a file cannot be written.
void write_gltf(const std::filesystem::path& folder, const GltfSwatch& swatch);

}  // namespace station
