#include "station/cloth/preview/cloth_preview.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "station/cloth/render/render_scene.h"
#include "station/cloth/render/white_card.h"
#include "station/documents/reader.h"
#include "station/documents/scene_file.h"
#include "station/output/display.h"
#include "station/output/interrupt.h"
#include "station/session/results.h"

namespace station {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int kQuickReduction = 2;  // of sizes and samples
constexpr int kMostSize_px = 20000;

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

// A white card before view and light are turned.
std::array<double, 3> white_of(const ClothStage& stage, const std::array<std::string, 2>& threads,
                               const fs::path& folder) {
  const SceneFile scene = parse_scene(scene_on_stage(stage, threads, {}, 1), stage.scene, folder);
  return radiance_of_white_card(scene, scene.white_card.value());
}

// The scene as somebody wishes to see it, written into the cloth's folder.
fs::path write_scene(const ClothPreviewRequest& request, const ClothStage& stage, const WovenThreads& woven) {
  json scene = scene_on_stage(stage, woven.files, request.view, scale_of(request, stage), woven.fibers);
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
  std::vector<const ClothStage*> stages;
  for (const std::string& shape : request.shapes) stages.push_back(&cloth_stage(shape));
  const WovenThreads woven = weave_threads(request.cloth, request.progress_style);
  json made_of = woven.made_of;
  for (const ClothStage* stage : stages) {
    const fs::path scene = write_scene(request, *stage, woven);
    fs::path picture = scene;
    picture.replace_extension(".exr");
    render_scene(
        {.scene = scene, .out = picture, .keep_finished = true, .only_this = true, .progress = request.progress_style});
    const std::array<double, 3> card = white_of(*stage, woven.files, request.cloth.out);
    made_of["white_card"][stage->shape] = card;
    made_of["views"][stage->shape] = to_json(request.view);
    const cv::Mat3f linear = renderer::read_exr(picture);
    if (stage->shape == "swatch" && request.view == ClothView{}) made_of["reflectance"] = reflectance_of(linear, card);
    renderer::write_png(picture.replace_extension(".png"),
                        display(linear, Exposure{.white = card}, woven.linear_srgb_from_camera));
  }
  write_json_file(request.cloth.out / kMadeOf, made_of);
  return made_of;
}

}  // namespace station
