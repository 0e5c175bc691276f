#include "station/cloth/cloth_preview.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "renderer/picture/camera.h"
#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "station/cloth/cloth_colour.h"
#include "station/cloth/draft_of_one_thread.h"
#include "station/cloth/render/build_scene.h"
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
namespace fs = std::filesystem;

// The stage of a picture: a ready scene in which cloth and thread are replaced.
struct Stage {
  const char* name;
  const char* scene;  // in station/data/scenes
  int width_px, height_px, samples_per_pixel;
  Eigen::Vector3d front_mm;  // the middle of the cloth's face
};
const std::array<Stage, 2> kStages{Stage{"swatch", "twill_swatch.json", 720, 720, 32, {0, 0, 0}},
                                   Stage{"cylinder", "satin_cylinder.json", 480, 720, 32, {41, 0, 84}}};
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

// The radiance (camera RGB) of a white card in the place of the scene's cloth that faces the camera.
std::array<double, 3> white_card(SceneFile scene, const Eigen::Vector3d& place_mm) {
  constexpr int kSide_px = 8, kSamples = 256;
  constexpr double kCard_mm = 10, kSeen_mm = 4;
  const Eigen::Vector3d eye = scene.camera.world_from_camera.translation(),
                        up = -scene.camera.world_from_camera.linear().col(1);
  scene.cloths.clear();
  scene.embroideries.clear();
  scene.objects = {{.shape = renderer::SwatchShape{.width_mm = kCard_mm, .height_mm = kCard_mm},
                    .world_from_object = renderer::look_at(place_mm, eye, up).world_from_camera,
                    .albedo = {1, 1, 1}}};
  renderer::Camera camera = renderer::look_at(eye, place_mm, up);
  camera.width = camera.height = kSide_px;
  camera.fx = camera.fy = kSide_px * (eye - place_mm).norm() / kSeen_mm;
  camera.cx = camera.cy = (kSide_px - 1) / 2.0;
  const cv::Scalar mean =
      cv::mean(renderer::PathTracer(build_scene(scene, {})).render(camera, {.samples_per_pixel = kSamples, .seed = 1}));
  return {mean[0], mean[1], mean[2]};
}

// The mean of the picture's middle over the card.
std::array<double, 3> reflectance_of(const cv::Mat3f& picture, const std::array<double, 3>& card) {
  const cv::Rect middle(picture.cols / 4, picture.rows / 4, picture.cols / 2, picture.rows / 2);
  const cv::Scalar mean = cv::mean(picture(middle));
  return {mean[0] / card[0], mean[1] / card[1], mean[2] / card[2]};
}

bool is_bundle_file(const fs::path& file) {
  return read_json_file(file).value("format", "") == "threadstation/bundle";
}

// The threads of warp and weft, in this order.
using Systems = std::array<fs::path, 2>;
constexpr std::array<const char*, 2> kSystems{"warp", "weft"};

// Writes the threads of systems that are coloured, and copies where they are asked for; returns the thread files of
// warp and weft as the scenes name them.
std::array<std::string, 2> write_threads(const ClothPreviewRequest& request, const Systems& own,
                                         const renderer::YarnPatch& patch, json& made_of) {
  std::array<std::string, 2> files;
  ProgressDisplay progress("cloth", request.progress_style);
  std::optional<ClothColours> colours;
  fs::path of;  // the thread whose colours these are
  for (std::size_t k = 0; k < kSystems.size(); ++k) {
    const std::string system = kSystems.at(k);
    const std::optional<Srgb8>& wanted = k == kWarp ? request.warp_colour : request.weft_colour;
    if (wanted) {
      if (is_bundle_file(own.at(k)))
        throw std::runtime_error("colours were given for a bundle, " + own.at(k).string() +
                                 ", and only a thread's absorption can be changed; leave them out, or take its thread");
      const ThreadFile thread = read_thread(own.at(k));
      if (of != own.at(k)) {
        constexpr int kParts = 100;
        colours.emplace(thread, patch, [&](double done) {
          progress.show(static_cast<int>(kParts * done), kParts, "what absorption makes of the cloth");
        });
        of = own.at(k);
      }
      const ColouredThread coloured = colours->thread_of(*wanted);
      ThreadFile made = thread;
      made.name += ", coloured as " + system;
      made.parameters = coloured.parameters;
      made.fit = json::object();  // it was never photographed
      files.at(k) = system + "_thread.json";
      write_json_file(request.out / files.at(k), to_json(made));
      made_of[system] = {{"srgb", *wanted}, {"delta_e_2000", coloured.delta_e_2000}};
    } else if (request.with_threads) {
      files.at(k) = system + "_thread.json";
      write_json_file(request.out / files.at(k), read_json_file(own.at(k)));
    } else {
      files.at(k) = fs::absolute(own.at(k)).lexically_relative(fs::absolute(request.out)).generic_string();
    }
  }
  if (colours) progress.finish("colours found");
  return files;
}

// Each system of the draft as thick as its thread.
renderer::Draft draft_of_threads(const fs::path& file, double warp_mm, double weft_mm) {
  renderer::Draft draft = draft_of_one_thread(read_draft(file), warp_mm);
  draft.warp.threads = {kWarp}, draft.weft.threads = {kWeft};
  if (warp_mm == weft_mm) return draft;
  const double scale = weft_mm / draft.weft.diameter_mm;
  draft.weft.diameter_mm *= scale;
  draft.weft.pitch_mm *= scale;
  return draft;
}

// Each calibration of a camera has a matrix of its own, which differs by little.
void require_one_camera(const Systems& own, const ClothThread& warp, const ClothThread& weft) {
  constexpr double kSame = 0.1;
  for (std::size_t i = 0; i < warp.linear_srgb_from_camera.size(); ++i)
    if (std::abs(warp.linear_srgb_from_camera.at(i) - weft.linear_srgb_from_camera.at(i)) > kSame)
      throw std::runtime_error("the colours of " + own[0].string() + " and " + own[1].string() +
                               " are those of two cameras, and one cloth is rendered in one camera's colours; take "
                               "threads that were digitized with the same camera");
}

}  // namespace

void weave_thread_of(ClothPreviewRequest& request, const fs::path& session_or_file, const std::string& model) {
  const bool session = fs::is_directory(session_or_file);
  request.with_threads = !request.out.empty();
  if (!session && request.out.empty())
    throw std::runtime_error("'" + session_or_file.string() +
                             "' is no session folder; for the cloth of a thread file say where it goes with --out");
  request.thread = session ? model_file_of(session_or_file, model) : session_or_file;
  if (request.out.empty()) request.out = cloth_folder(session_or_file);
}

json preview_cloth(const ClothPreviewRequest& request) {
  watch_interrupts();
  const Systems own{request.thread, request.weft_thread.empty() ? request.thread : request.weft_thread};
  const ClothThread thread = read_cloth_thread(own[kWarp]), weft = read_cloth_thread(own[kWeft]);
  require_one_camera(own, thread, weft);
  const fs::path& folder = request.out;
  std::error_code code;
  fs::create_directories(folder, code);
  if (code)
    throw std::runtime_error("cannot make " + folder.string() + ": " + code.message() +
                             "; is the folder that it is in writable?");
  const renderer::Draft draft = draft_of_threads(request.draft, thread.diameter_mm, weft.diameter_mm);
  ProgressDisplay progress("cloth", request.progress_style);
  const renderer::YarnPatch patch = weave_watched(draft, progress).patch;
  write_json_file(folder / "draft.json", to_json(draft));
  write_json_file(folder / "patch.json", to_json(patch));
  json made_of{{"draft", draft.name}, {"warp", nullptr}, {"weft", nullptr}};
  made_of["model"] = is_bundle_file(own[kWarp]) ? "bundle" : "thread";
  made_of["threads"] = {read_json_file(own[kWarp]).value("name", ""), read_json_file(own[kWeft]).value("name", "")};
  const std::array<std::string, 2> threads = write_threads(request, own, patch, made_of);
  for (const Stage& stage : kStages) {
    const fs::path scene = folder / (std::string(stage.name) + ".json");
    write_json_file(scene, scene_of(stage, threads, request.quick));
    fs::path picture = scene;
    picture.replace_extension(".exr");
    render_scene({.scene = scene, .out = picture, .progress = request.progress_style});
    const std::array<double, 3> card = white_card(read_scene(scene), stage.front_mm);
    made_of["white_card"][stage.name] = card;
    const cv::Mat3f linear = renderer::read_exr(picture);
    if (!made_of.contains("reflectance")) made_of["reflectance"] = reflectance_of(linear, card);  // of the swatch
    renderer::write_png(picture.replace_extension(".png"),
                        display(linear, Exposure{.white = card}, thread.linear_srgb_from_camera));
  }
  write_json_file(folder / kMadeOf, made_of);
  return made_of;
}

}  // namespace station
