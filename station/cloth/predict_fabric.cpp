#include "station/cloth/predict_fabric.h"

#include <nlohmann/json.hpp>

#include "renderer/picture/image_file.h"
#include "renderer/weave/patch_measures.h"
#include "station/bench/cloth_on_cylinder.h"
#include "station/documents/disk/stored_file.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"

namespace station {

nlohmann::json to_json(const PredictedView& view) {
  return {{"view", view.view},
          {"prediction", view.prediction.string()},
          {"block_px", view.block_px},
          {"comparison", to_json(view.comparison)}};
}

std::vector<PredictedView> predict_fabric(const PredictRequest& request) {
  watch_interrupts();
  const SessionFile asked = read_session_file(request.cloth.session);
  const WovenModels weave = woven_models(request.cloth, asked.spool);
  const DevelopedViews developed = pictures_of_fabric(request.cloth.session);
  ProgressDisplay progress("predict", request.progress_style);
  const renderer::YarnPatch patch = weave_watched(weave.draft, progress).patch;
  const std::filesystem::path fabric = request.cloth.session / "result" / "fabric",
                              folder = request.cloth.model == "thread" ? fabric : fabric / request.cloth.model;
  make_folder(folder);
  std::vector<PredictedView> predicted;
  for (const DevelopedView& photographed : developed.views) {
    const inversion::View& view = photographed.view;
    progress.show(static_cast<int>(predicted.size()), static_cast<int>(developed.views.size()), view.id);
    const cv::Mat3f picture = predicted_picture(*asked.spool.fabric, patch, weave.threads, view,
                                                request.samples_per_pixel, request.seed + predicted.size());
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
