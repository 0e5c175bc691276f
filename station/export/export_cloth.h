// A cloth for other programs: a tileable set of textures, glTF and U3M, and a sheet that shows how near they come. The work
// behind `threadstation export cloth`; cloth.md says what is exact and what is approximate.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "station/export/cloth_sheet.h"
#include "station/export/pbr_fit.h"
#include "station/progress.h"

namespace station {

enum class ClothExport { textures, gltf, u3m };

struct ExportClothRequest {
  std::filesystem::path scene;              // of one flat cloth; or instead of it
  std::filesystem::path draft, warp, weft;  // a draft and two thread files
  std::filesystem::path out;                // a folder that is not there yet
  int size_px = 256;                        // of the textures' longer side
  int samples_per_texel = 64;               // of far views and of the sheet in proportion
  std::set<ClothExport> formats{ClothExport::textures, ClothExport::gltf, ClothExport::u3m};
  std::uint64_t seed = 1;
  double most_bytes = 0;  // of memory; 0: half of the machine's
  ProgressStyle progress = ProgressStyle::automatic;
};

inline constexpr int kLeastExportSize = 16, kMostExportSize = 8192;

struct ExportClothReport {
  std::string name, folder;
  cv::Size size_px;
  double width_mm = 0, height_mm = 0;  // of the period
  GltfMaterial material;
  bool converged = false;
  FarFieldAgreement front_light, back_light;
  EvenLight::Seen even_cloth, even_export;  // mean over the face, under even light from in front and from behind
  std::vector<FarFieldError> pairs;
  std::vector<ComparedView> views;
};

// Writes, each only if asked for, out/textures, out/gltf and out/u3m, and always out/comparison.png and out/export.json (the
// report). Everything is made under a temporary name beside `out` first. Errors: std::runtime_error, one line: those of
// cloth_sample.h, `out` exists or cannot be made, more memory than there is, stopped by ctrl-C.
ExportClothReport export_cloth(const ExportClothRequest& request);

nlohmann::json to_json(const ExportClothReport& report);
std::string describe(const ExportClothReport& report);

}  // namespace station
