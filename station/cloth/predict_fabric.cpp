#include "station/cloth/predict_fabric.h"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <tuple>

#include "inversion/view/view.h"
#include "renderer/picture/image_file.h"
#include "renderer/trace/path_tracer.h"
#include "renderer/weave/patch_measures.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/documents/bundle_file.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/number_text.h"
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

MeasuredSett measure_sett(const std::filesystem::path& session, const std::filesystem::path& fabric,
                          ProgressStyle progress_style) {
  watch_interrupts();
  const SessionFile asked = read_session_file(session);
  const Weave weave = own_weave_of({.session = session, .fabric = fabric}, asked.spool);
  DevelopedViews developed = read_views(session);
  read_view_pictures(session, developed);
  ProgressDisplay progress("predict", progress_style);
  const renderer::YarnPatch patch = weave_watched(weave.draft, progress).patch;
  MeasuredSett sett{.said_around_mm = patch.period_x_mm,
                    .said_along_mm = patch.period_y_mm,
                    .ends = ends_in_patch(weave.draft),
                    .picks = picks_in_patch(weave.draft),
                    .draft = weave.draft};
  std::vector<PhotographedCloth> pictures;
  for (const DevelopedView& one : developed.views)
    pictures.push_back({.image = one.view.image, .mask = one.view.mask, .camera = one.view.camera});
  const renderer::SurfaceRange range = renderer::surface_range(patch);
  const double middle_mm = asked.spool.fabric->cylinder.radius_mm - range.low_mm;
  progress.show(0, 1, "the repeat in the photographs");
  sett.periods = measure_periods(pictures, {.crown_radius_mm = middle_mm + range.high_mm,
                                            .middle_radius_mm = middle_mm,
                                            .around_mm = patch.period_x_mm,
                                            .along_mm = patch.period_y_mm});
  if (const auto& around = sett.periods.around_mm) sett.draft.warp.pitch_mm *= around->value / patch.period_x_mm;
  if (const auto& along = sett.periods.along_mm) sett.draft.weft.pitch_mm *= along->value / patch.period_y_mm;
  progress.finish(std::to_string(sett.periods.waves) + " waves of the weave");
  return sett;
}

std::string describe(const MeasuredSett& sett) {
  std::string text;
  for (const auto& [name, measured, said, yarns] :
       {std::tuple{"ends", sett.periods.around_mm, sett.said_around_mm, sett.ends},
        {"picks", sett.periods.along_mm, sett.said_along_mm, sett.picks}}) {
    text += std::string(name) + " per cm: ";
    if (measured) {
      const double per_cm = 10 * yarns / measured->value;
      text += number_text(per_cm, 2) + " +- " + number_text(per_cm * measured->sigma / measured->value, 2);
    } else {
      text += "cannot be seen in the photographs";
    }
    text += " (the fabric says " + number_text(10 * yarns / said, 2) + ")\n";
  }
  return text;
}

nlohmann::json to_json(const MeasuredSett& sett) {
  const auto of = [](const std::optional<MeasuredValue>& period, int yarns) {
    if (!period) return nlohmann::json();
    return nlohmann::json{{"period_mm", period->value},
                          {"period_sigma_mm", period->sigma},
                          {"per_cm", 10 * yarns / period->value},
                          {"per_cm_sigma", 10 * yarns * period->sigma / (period->value * period->value)}};
  };
  return {{"ends", of(sett.periods.around_mm, sett.ends)},
          {"picks", of(sett.periods.along_mm, sett.picks)},
          {"waves", sett.periods.waves},
          {"said_ends_per_cm", 10 * sett.ends / sett.said_around_mm},
          {"said_picks_per_cm", 10 * sett.picks / sett.said_along_mm}};
}

}  // namespace station
