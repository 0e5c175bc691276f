// Scene files (kind "scene"): cloths of digitized threads, bodies under them, lights and a camera; keys in
// station/data/scenes/README.md. The files that a scene names (threads, drafts, patches, motifs, meshes, pictures) are
// named relative to it and read with it. Nothing is woven or draped here: that is cloth/render/build_scene.h.
//
// Errors: those of reader.h and of the files that the scene names.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "renderer/embroidery/motif.h"
#include "renderer/picture/camera.h"
#include "renderer/scene/cloth_shape.h"
#include "renderer/scene/garment.h"
#include "renderer/scene/scene.h"
#include "renderer/weave/draft.h"
#include "station/documents/cloth_fibers.h"

namespace station {

// A garment that the program makes; `turn_rad` turns the weave in its pattern.
struct SceneGarment {
  renderer::GarmentShape shape;
  double turn_rad = 0;
};
using SceneShape = std::variant<renderer::SwatchShape, renderer::CylinderShape, renderer::MeshShape, SceneGarment>;

struct SceneCloth {
  std::variant<renderer::Draft, renderer::YarnPatch> weave;
  std::optional<renderer::AbsorptionTexture> absorption{};
  std::optional<ClothFibers> fibers{};
  SceneShape shape{};
  Eigen::Isometry3d world_from_cloth = Eigen::Isometry3d::Identity();
  bool two_scale = true;  // otherwise brute force: every yarn as curves
};

// A motif that is sewn on a cloth. Its middle lies at `at_mm` (millimetres of the patch), or else in the middle of the
// cloth.
struct SceneEmbroidery {
  renderer::Motif motif;
  std::vector<renderer::ThreadParameters> threads;  // of the motif
  double diameter_mm = 0.4;
  int cloth = 0;
  std::optional<Eigen::Vector2d> at_mm;
  double turn_rad = 0;
};

struct SceneBody {
  SceneShape shape;  // no garment
  Eigen::Isometry3d world_from_object = Eigen::Isometry3d::Identity();
  cv::Vec3f albedo{0, 0, 0};
};

// A card that stands nowhere in the picture, and is seen along its normal.
struct WhiteCard {
  Eigen::Vector3d position_mm{0, 0, 0}, normal{0, 0, 1};
};

struct SceneFile {
  std::string source;  // the file, for messages
  std::string name{};
  std::vector<renderer::ScatteringModel> threads{};
  std::array<double, 9> linear_srgb_from_camera{1, 0, 0, 0, 1, 0, 0, 0, 1};  // the first thread's; for display only
  std::vector<SceneCloth> cloths{};
  std::vector<SceneEmbroidery> embroideries{};
  std::vector<SceneBody> objects{};
  std::vector<renderer::SphereLight> lights{};
  std::vector<renderer::RectangleLight> rectangles{};
  std::optional<renderer::EnvironmentLight> surroundings{};  // as a picture
  renderer::Camera camera{};
  int samples_per_pixel = 64;
  std::optional<double> brightness{};     // radiance times this is shown as white = 1; from the picture when left out
  std::optional<WhiteCard> white_card{};  // or, where that is left out, such that this would be white
};

SceneFile parse_scene(const nlohmann::json& document, const std::string& source, const std::filesystem::path& folder);
SceneFile read_scene(const std::filesystem::path& file);

// The line that refuses a cloth with yarns of a thread that its scene does not list; nothing when all are listed.
std::optional<std::string> missing_thread(const std::string& cloth, const std::vector<int>& threads,
                                          std::size_t listed);

}  // namespace station
