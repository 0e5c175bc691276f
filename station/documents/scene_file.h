// Scene files (kind "scene"): cloths of digitized threads, bodies under them, lights and a camera; keys in
// fixtures/scenes/README.md. Threads, drafts and patches are named relative to the scene file and read with it.
//
// Errors: those of reader.h and of the files that the scene names.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "renderer/camera.h"
#include "renderer/cloth_shape.h"
#include "renderer/embroidery/motif.h"
#include "renderer/scene.h"

namespace station {

struct SceneCloth {
  renderer::YarnPatch patch;
  Eigen::Vector2i crossings;  // warp ends and weft picks in the patch
  std::optional<renderer::AbsorptionTexture> absorption{};
  renderer::ClothShape shape;
  Eigen::Isometry3d world_from_cloth = Eigen::Isometry3d::Identity();
  bool two_scale = true;  // otherwise brute force: every yarn as curves
};

// Sewn on a cloth, its middle where `at_mm` says: in millimetres of the patch, or in the middle of the cloth.
struct SceneEmbroidery {
  renderer::Motif motif;
  std::vector<renderer::ThreadParameters> threads;  // of the motif
  double diameter_mm = 0.4;
  int cloth = 0;
  std::optional<Eigen::Vector2d> at_mm;
  double turn_rad = 0;
};

struct SceneBody {
  renderer::ClothShape shape;
  Eigen::Isometry3d world_from_object = Eigen::Isometry3d::Identity();
  cv::Vec3f albedo{0, 0, 0};
};

struct SceneFile {
  std::string name;
  std::vector<renderer::ThreadParameters> threads;
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // the first thread's; for display only
  std::vector<SceneCloth> cloths;
  std::vector<SceneEmbroidery> embroideries;
  std::vector<SceneBody> objects;
  std::vector<renderer::SphereLight> lights;
  std::vector<renderer::RectangleLight> rectangles;
  std::optional<renderer::EnvironmentLight> surroundings;  // as a picture
  renderer::Camera camera;
  int samples_per_pixel = 64;
  std::optional<double> exposure;  // radiance times this is shown as white = 1; from the picture when left out
};

SceneFile parse_scene(const nlohmann::json& document, const std::string& source, const std::filesystem::path& folder);
SceneFile read_scene(const std::filesystem::path& file);

// Errors: those of renderer::surface_of, explicit_curves, stitch_curves and sewn_curves.
renderer::Scene to_scene(const SceneFile& file);

}  // namespace station
