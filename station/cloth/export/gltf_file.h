// A square swatch of cloth as glTF 2.0: cloth.gltf, cloth.bin and five PNG files.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "station/cloth/export/gltf_brdf.h"
#include "station/cloth/export/pbr_maps.h"

namespace station {

inline constexpr double kGltfSwatch_mm = 100;  // side of the swatch, which faces +z, the warp along +y

struct GltfSwatch {
  std::string name;
  double period_x_mm = 1, period_y_mm = 1;  // size of the period that the maps show
  const PbrMaps& maps;                      // maps of the face; the back shows them too
  GltfMaterial material;
  nlohmann::json extras = nlohmann::json::object();  // the material's "extras", for people
};

// Writes the files, with lengths in metres as glTF has them. Errors: std::runtime_error, one line, when a file cannot
// be written.
void write_gltf(const std::filesystem::path& folder, const GltfSwatch& swatch);

}  // namespace station
