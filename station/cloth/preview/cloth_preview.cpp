#include "station/cloth/preview/cloth_preview.h"

#include <algorithm>
#include <cctype>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "renderer/scene/mesh_file.h"
#include "station/cloth/render/render_scene.h"
#include "station/cloth/render/white_card.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"
#include "station/documents/scene_file.h"
#include "station/documents/scene_names.h"
#include "station/output/display.h"
#include "station/output/interrupt.h"
#include "station/session/results.h"

namespace station {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int kQuickReduction = 2;  // of sizes and samples
constexpr int kMostSize_px = 20000;
constexpr double kMetre_mm = 1000, kLeastMesh_mm = 20, kMostMesh_mm = 20000;

// The mean of the picture's middle over the card.
std::array<double, 3> reflectance_of(const cv::Mat3f& picture, const std::array<double, 3>& card) {
  const cv::Rect middle(picture.cols / 4, picture.rows / 4, picture.cols / 2, picture.rows / 2);
  const cv::Scalar mean = cv::mean(picture(middle));
  return {mean[0] / card[0], mean[1] / card[1], mean[2] / card[2]};
}

double scale_of(const ClothPreviewRequest& request, const ClothStage& stage) {
  if (request.size_px > 0) return scale_to(stage, request.size_px);
  return request.quick ? 1.0 / kQuickReduction : 1.0;
}

// A picture to be made: of cloth in one shape.
struct Shown {
  const ClothStage& stage;
  OnStage cloth;
};

// A white card before view and light are turned, in the light of the lamps that the stage has by itself or, where the
// light comes from all around, in that.
std::array<double, 3> white_of(const Shown& shown, const fs::path& folder) {
  OnStage cloth = shown.cloth;
  if (cloth.lights != "even" && std::ranges::count(cloth_lights(), cloth.lights)) cloth.lights = "studio";
  const SceneFile scene = parse_scene(scene_on_stage(shown.stage, cloth, {}, 1), shown.stage.scene, folder);
  return radiance_of_white_card(scene, scene.white_card.value());
}

bool is_shape(const std::string& shape) {
  const std::vector<std::string> shapes = cloth_shapes();
  return std::ranges::find(shapes, shape) != shapes.end();
}

StagedMesh staged(const fs::path& file, const ClothPreviewRequest& request) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  const double unit_mm = request.mesh_unit_mm.value_or(ending == ".gltf" || ending == ".glb" ? kMetre_mm : 1);
  StagedMesh mesh{.file = name_from(request.cloth.out, file), .unit_mm = unit_mm};
  for (const Eigen::Vector3d& place : renderer::read_mesh(file).vertices) mesh.box_mm.extend(unit_mm * place);
  if (const double size_mm = mesh.box_mm.diagonal().norm(); !(size_mm >= kLeastMesh_mm && size_mm <= kMostMesh_mm))
    throw std::runtime_error(file.string() + " is " + number_text(size_mm, 3) +
                             " mm from corner to corner, which no garment is; say with --mesh-unit how many "
                             "millimetres one unit of its coordinates is");
  return mesh;
}

// What all pictures are of, in the order in which they were asked for.
std::vector<Shown> shown_in(const ClothPreviewRequest& request) {
  if (std::ranges::count_if(request.shapes, [](const std::string& shape) { return !is_shape(shape); }) > 1)
    throw std::runtime_error("several meshes were given, and each would be the folder's mesh.exr; give one at a time");
  std::vector<Shown> all;
  for (const std::string& shape : request.shapes) {
    OnStage cloth{.threads = {}, .lights = request.lights};
    if (!std::ranges::count(cloth_lights(), request.lights))
      cloth.lights = name_from(request.cloth.out, request.lights);
    if (!is_shape(shape)) cloth.mesh = staged(shape, request);
    all.push_back({cloth_stage(cloth.mesh ? kMeshShape : shape), cloth});
  }
  return all;
}

// The scene as somebody wishes to see it, written into the cloth's folder.
fs::path write_scene(const ClothPreviewRequest& request, const Shown& shown) {
  const ClothStage& stage = shown.stage;
  json scene = scene_on_stage(stage, shown.cloth, request.view, scale_of(request, stage));
  if (request.quick) scene["samples_per_pixel"] = stage.samples_per_pixel / kQuickReduction;
  const fs::path file = request.cloth.out / (stage.shape + ".json");
  write_json_file(file, scene);
  return file;
}

}  // namespace

void weave_thread_of(ThreadsToWeave& wanted, const fs::path& session_or_file, const std::string& model) {
  const bool session = fs::is_directory(session_or_file);
  wanted.with_threads = !wanted.out.empty();
  if (!session && wanted.out.empty())
    throw std::runtime_error("'" + session_or_file.string() +
                             "' is no session folder; for the cloth of a thread file say where it goes with --out");
  wanted.thread = session ? model_file_of(session_or_file, model) : session_or_file;
  if (wanted.out.empty()) wanted.out = cloth_folder(session_or_file);
}

json preview_cloth(const ClothPreviewRequest& request) {
  watch_interrupts();
  if (const auto problem = problem_of(request.view)) throw std::runtime_error(*problem);
  if (request.size_px < 0 || request.size_px > kMostSize_px)
    throw std::runtime_error("pictures cannot be " + std::to_string(request.size_px) + " pixels large; give up to " +
                             std::to_string(kMostSize_px));
  std::vector<Shown> pictures = shown_in(request);
  const WovenThreads woven = weave_threads(request.cloth, request.progress_style);
  json made_of = woven.made_of;
  for (Shown& shown : pictures) {
    const ClothStage* stage = &shown.stage;
    shown.cloth.threads = woven.files, shown.cloth.fibers = woven.fibers;
    const fs::path scene = write_scene(request, shown);
    fs::path picture = scene;
    picture.replace_extension(".exr");
    render_scene(
        {.scene = scene, .out = picture, .keep_finished = true, .only_this = true, .progress = request.progress_style});
    const std::array<double, 3> card = white_of(shown, request.cloth.out);
    made_of["white_card"][stage->shape] = card;
    made_of["views"][stage->shape] = to_json(request.view);
    const cv::Mat3f linear = renderer::read_exr(picture);
    if (stage->shape == "swatch" && request.view == ClothView{} && request.lights == "studio")
      made_of["reflectance"] = reflectance_of(linear, card);
    renderer::write_png(picture.replace_extension(".png"),
                        display(linear, Exposure{.white = card}, woven.linear_srgb_from_camera));
  }
  write_json_file(request.cloth.out / kMadeOf, made_of);
  return made_of;
}

}  // namespace station
