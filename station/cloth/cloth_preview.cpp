#include "station/cloth/cloth_preview.h"

#include <array>
#include <stdexcept>

#include "renderer/picture/image_file.h"
#include "station/cloth/cloth_colour.h"
#include "station/cloth/draft_of_one_thread.h"
#include "station/cloth/render/render_scene.h"
#include "station/data/data_folder.h"
#include "station/documents/bundle_file.h"
#include "station/documents/draft_file.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"
#include "station/documents/thread_file.h"
#include "station/output/display.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"
#include "station/session/results.h"
#include "station/thread/invert/invert_session.h"

namespace station {
namespace {

using nlohmann::json;

// The stage of a picture: a ready scene in which cloth and thread are replaced.
struct Stage {
  const char* name;
  const char* scene;  // in station/data/scenes
  int width_px, height_px, samples_per_pixel;
};
constexpr std::array<Stage, 2> kStages{Stage{"swatch", "twill_swatch.json", 360, 360, 32},
                                       Stage{"cylinder", "satin_cylinder.json", 280, 420, 32}};
constexpr int kQuickReduction = 2;   // of sizes and samples
constexpr int kWarp = 0, kWeft = 1;  // threads of the draft

json scene_of(const Stage& stage, const std::array<std::string, 2>& threads, bool quick) {
  json scene = read_json_file(data_folder() / "scenes" / stage.scene);
  scene["name"] = std::string("the thread as a ") + stage.name;
  scene["threads"] = threads;
  for (json& cloth : scene["cloths"]) {
    for (const char* key : {"draft", "warp_threads", "weft_threads"}) cloth.erase(key);
    cloth["patch"] = "patch.json";
  }
  json& camera = scene["camera"];
  const int reduction = quick ? kQuickReduction : 1;
  const double zoom = static_cast<double>(stage.width_px) / camera["width_px"].get<double>() / reduction;
  camera["width_px"] = stage.width_px / reduction;
  camera["height_px"] = stage.height_px / reduction;
  camera["focal_length_px"] = camera["focal_length_px"].get<double>() * zoom;
  scene["samples_per_pixel"] = stage.samples_per_pixel / reduction;
  return scene;
}

// Writes the threads of systems that are coloured; returns the thread files of warp and weft as the scenes name them.
std::array<std::string, 2> write_threads(const ClothPreviewRequest& request, const renderer::YarnPatch& patch,
                                         json& made_of) {
  const std::string own =
      model_file_of(request.session, request.model).lexically_relative(cloth_folder(request.session)).generic_string();
  std::array<std::string, 2> files{own, own};
  if (!request.warp_colour && !request.weft_colour) return files;
  if (request.model != "thread")
    throw std::runtime_error("colours were given for a " + request.model +
                             ", and only a thread's absorption can be changed; leave them out, or take --model thread");
  const ThreadFile thread = read_thread(thread_file_of(request.session));
  constexpr int kParts = 100;
  ProgressDisplay progress("cloth", request.progress_style);
  const ClothColours colours(thread, patch, [&](double done) {
    progress.show(static_cast<int>(kParts * done), kParts, "what absorption makes of the cloth");
  });
  const auto colour = [&](const char* system, const std::optional<Srgb8>& wanted, std::string& file) {
    if (!wanted) return;
    const ColouredThread coloured = colours.thread_of(*wanted);
    ThreadFile made = thread;
    made.name += std::string(", coloured as ") + system;
    made.parameters = coloured.parameters;
    made.fit = json::object();  // it was never photographed
    file = std::string(system) + "_thread.json";
    write_json_file(cloth_folder(request.session) / file, to_json(made));
    made_of[system] = {{"srgb", *wanted}, {"delta_e_2000", coloured.delta_e_2000}};
  };
  colour("warp", request.warp_colour, files[0]);
  colour("weft", request.weft_colour, files[1]);
  progress.finish("colours found");
  return files;
}

}  // namespace

json preview_cloth(const ClothPreviewRequest& request) {
  watch_interrupts();
  const ClothThread thread = read_cloth_thread(model_file_of(request.session, request.model));
  const std::filesystem::path folder = cloth_folder(request.session);
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code)
    throw std::runtime_error("cannot make " + folder.string() + ": " + code.message() +
                             "; is the session's folder writable?");
  renderer::Draft draft = draft_of_one_thread(read_draft(request.draft), thread.diameter_mm);
  draft.warp.threads = {kWarp}, draft.weft.threads = {kWeft};
  ProgressDisplay progress("cloth", request.progress_style);
  const renderer::YarnPatch patch = weave_watched(draft, progress).patch;
  write_json_file(folder / "draft.json", to_json(draft));
  write_json_file(folder / "patch.json", to_json(patch));
  json made_of{{"draft", draft.name}, {"model", request.model}, {"warp", nullptr}, {"weft", nullptr}};
  const std::array<std::string, 2> threads = write_threads(request, patch, made_of);
  for (const Stage& stage : kStages) {
    const std::filesystem::path scene = folder / (std::string(stage.name) + ".json");
    write_json_file(scene, scene_of(stage, threads, request.quick));
    std::filesystem::path picture = scene;
    picture.replace_extension(".exr");
    render_scene({.scene = scene, .out = picture, .progress = request.progress_style});
    const cv::Mat3b shown = display(renderer::read_exr(picture), thread.linear_srgb_from_camera);
    renderer::write_png(picture.replace_extension(".png"), shown);
  }
  write_json_file(cloth_made_of_file(request.session), made_of);
  return made_of;
}

}  // namespace station
