// The export of a cloth to other programs: a tileable set of textures, glTF and U3M, and a sheet that shows how near
// they come. This is the work behind `threadstation export cloth`; cloth.md tells what is exact and what is
// approximate.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "station/cloth/export/cloth_sheet.h"
#include "station/cloth/export/pbr_fit.h"
#include "station/output/progress.h"

namespace station {

enum class ClothExport { textures, gltf, u3m };

struct ExportClothRequest {
  std::filesystem::path scene;              // a scene of one flat cloth, or instead of it ...
  std::filesystem::path draft, warp, weft;  // ... a draft and two thread files
  std::filesystem::path out;                // a folder that is not there yet
  int size_px = 256;                        // longer side of the textures
  int samples_per_texel = 64;               // the far field and the sheet take samples in proportion
  std::set<ClothExport> formats{ClothExport::textures, ClothExport::gltf, ClothExport::u3m};
  std::uint64_t seed = 1;
  double most_bytes = 0;  // most memory to be used; 0: half of the machine's
  ProgressStyle progress = ProgressStyle::automatic;
};

inline constexpr int kLeastExportSize = 16, kMostExportSize = 8192;

struct ExportClothReport {
  std::string name, folder;
  cv::Size size_px;
  double width_mm = 0, height_mm = 0;  // size of the period
  GltfMaterial material;
  bool converged = false;
  FarFieldAgreement front_light, back_light;
  EvenLight::Seen even_cloth, even_export;  // means over the face under even light
  std::vector<FarFieldError> pairs;
  std::vector<ComparedView> views;
};

// Writes out/textures, out/gltf and out/u3m, each only if asked for, and always out/comparison.png and out/export.json
// (the report). Everything is made under a temporary name beside `out` first. Errors: std::runtime_error, one line:
// those of cloth_sample.h, `out` exists or cannot be made, more memory needed than allowed, stopped by ctrl-C.
ExportClothReport export_cloth(const ExportClothRequest& request);

nlohmann::json to_json(const ExportClothReport& report);
std::string describe(const ExportClothReport& report);

}  // namespace station
