#include "station/cloth/predict_fabric.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "inversion/view/view.h"
#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/session_file.h"
#include "station/documents/views_file.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"

namespace station {
namespace {

Weave weave_of(const PredictRequest& request, const Spool& photographed) {
  if (!photographed.fabric)
    throw std::runtime_error(request.session.string() + " is a session of a wrapped thread (" + photographed.name +
                             "); give one of a cloth on the cylinder, or use invert");
  const Spool asked = request.fabric.empty() ? photographed : read_spool(request.fabric);
  if (asked.fabric && asked.fabric->weave) return *asked.fabric->weave;
  throw std::runtime_error((request.fabric.empty() ? request.session.string() : request.fabric.string()) +
                           " does not say what the cloth is woven of; give --fabric with a \"weave\"");
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
  const Weave weave = weave_of(request, asked.spool);
  DevelopedViews developed = read_views(request.session);
  read_view_pictures(request.session, developed);
  ProgressDisplay progress("predict", request.progress_style);
  const renderer::YarnPatch patch = weave_watched(weave.draft, progress).patch;
  const std::filesystem::path folder = request.session / "result" / "fabric";
  make_folder(folder);
  std::vector<PredictedView> predicted;
  for (const DevelopedView& photographed : developed.views) {
    const inversion::View& view = photographed.view;
    progress.show(static_cast<int>(predicted.size()), static_cast<int>(developed.views.size()), view.id);
    renderer::Scene scene;
    add_cloth_on_cylinder(scene, asked.spool.fabric->cylinder, patch, {weave.threads.begin(), weave.threads.end()});
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
