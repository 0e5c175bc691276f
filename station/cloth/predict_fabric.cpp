#include "station/cloth/predict_fabric.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "inversion/view/view.h"
#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/documents/bundle_file.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/session_file.h"
#include "station/documents/views_file.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"
#include "station/session/results.h"

namespace station {
namespace {

Weave own_weave_of(const PredictRequest& request, const Spool& photographed) {
  if (!photographed.fabric)
    throw std::runtime_error(request.session.string() + " is a session of a wrapped thread (" + photographed.name +
                             "); give one of a cloth on the cylinder, or use invert");
  const Spool asked = request.fabric.empty() ? photographed : read_spool(request.fabric);
  if (asked.fabric && asked.fabric->weave) return *asked.fabric->weave;
  throw std::runtime_error((request.fabric.empty() ? request.session.string() : request.fabric.string()) +
                           " does not say what the cloth is woven of; give --fabric with a \"weave\"");
}

renderer::ScatteringModel digitized(const std::filesystem::path& session_or_file, const std::string& model) {
  if (!std::filesystem::is_directory(session_or_file)) return read_model(session_or_file);
  const std::filesystem::path file = model_file_of(session_or_file, model);
  if (!std::filesystem::exists(file))
    throw std::runtime_error(session_or_file.string() + " has no fitted " + model + "; run: threadstation invert " +
                             session_or_file.string() + (model == "thread" ? "" : " --model " + model));
  return read_model(file);
}

struct WovenModels {
  renderer::Draft draft;
  std::vector<renderer::ScatteringModel> threads;
};

WovenModels woven_models(const PredictRequest& request, const Spool& photographed) {
  const Weave weave = own_weave_of(request, photographed);
  WovenModels woven{.draft = weave.draft, .threads = {weave.threads.begin(), weave.threads.end()}};
  if (request.warp.empty() != request.weft.empty())
    throw std::runtime_error(std::string("only the ") + (request.warp.empty() ? "weft" : "warp") +
                             " was given; give both, --warp and --weft, as sessions or model files");
  if (request.warp.empty() && request.model != "thread")
    throw std::runtime_error(
        "the fabric's own threads are thread models; give the sessions of its warp and weft, each "
        "fitted with invert --model " +
        request.model + ", as --warp and --weft");
  if (request.warp.empty()) return woven;
  woven.draft.warp.threads = {0}, woven.draft.weft.threads = {1};
  woven.threads = {digitized(request.warp, request.model), digitized(request.weft, request.model)};
  return woven;
}

}  // namespace

nlohmann::json to_json(const PredictedView& view) {
  return {{"view", view.view},
          {"prediction", view.prediction.string()},
          {"block_px", view.block_px},
          {"comparison", to_json(view.comparison)}};
}

std::vector<PredictedView> predict_fabric(const PredictRequest& request) {
  watch_interrupts();
  const SessionFile asked = read_session_file(request.session);
  const WovenModels weave = woven_models(request, asked.spool);
  DevelopedViews developed = read_views(request.session);
  read_view_pictures(request.session, developed);
  ProgressDisplay progress("predict", request.progress_style);
  const renderer::YarnPatch patch = weave_watched(weave.draft, progress).patch;
  const std::filesystem::path fabric = request.session / "result" / "fabric",
                              folder = request.model == "thread" ? fabric : fabric / request.model;
  make_folder(folder);
  std::vector<PredictedView> predicted;
  for (const DevelopedView& photographed : developed.views) {
    const inversion::View& view = photographed.view;
    progress.show(static_cast<int>(predicted.size()), static_cast<int>(developed.views.size()), view.id);
    renderer::Scene scene;
    add_cloth_on_cylinder(scene, asked.spool.fabric->cylinder, patch, weave.threads);
    scene.lights.push_back(inversion::sphere_light(view.light));
    const renderer::PathTracer tracer(scene);
    const cv::Mat3f picture = tracer.render(view.camera, {.samples_per_pixel = request.samples_per_pixel,
                                                          .seed = request.seed + predicted.size(),
                                                          .only = view.mask,
                                                          .progress = [](double) { return !interrupted(); }});
    PredictedView next{.view = view.id,
                       .prediction = folder / (view.id + ".exr"),
                       .beside = folder / (view.id + ".png"),
                       .block_px = comparable_block_px(patch, view.camera),
                       .comparison = {}};
    const CompareOptions options{.fit_scale = request.fit_scale,
                                 .block_px = next.block_px,
                                 .linear_srgb_from_camera = developed.linear_srgb_from_camera};
    next.comparison = compare_pictures(view.image, picture, view.mask, options);
    renderer::write_exr(next.prediction, picture,
                        {{"threadstation/content", "linear camera RGB, radiance unit (full scale per second)"},
                         {"threadstation/view", view.id},
                         {"threadstation/software", software_version()}});
    renderer::write_png(next.beside, comparison_picture(view.image, picture, view.mask, options));
    predicted.push_back(next);
  }
  progress.finish(std::to_string(predicted.size()) + " views");
  return predicted;
}

}  // namespace station
