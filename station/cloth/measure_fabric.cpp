#include "station/cloth/measure_fabric.h"

#include <nlohmann/json.hpp>
#include <tuple>

#include "renderer/weave/patch_measures.h"
#include "station/documents/number_text.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"

namespace station {

MeasuredSett measure_sett(const SaidFabric& cloth, ProgressStyle progress_style) {
  watch_interrupts();
  const SessionFile asked = read_session_file(cloth.session);
  const WovenModels weave = woven_models(cloth, asked.spool);
  const DevelopedViews developed = pictures_of_fabric(cloth.session);
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

MeasuredFabric measure_fabric(const MeasureFabricRequest& request) {
  MeasuredFabric measured;
  if (request.sett) {
    measured.sett = measure_sett(request.cloth, request.progress_style);
    measured.draft = measured.sett->draft;
  }
  if (request.height) {
    measured.height = measure_height({.cloth = request.cloth,
                                      .samples_per_pixel = request.samples_per_pixel,
                                      .seed = request.seed,
                                      .progress_style = request.progress_style});
    if (!measured.sett) measured.draft = measured.height->draft;
    measured.draft.height_scale = measured.height->draft.height_scale;
  }
  return measured;
}

std::string describe(const MeasuredFabric& measured) {
  return (measured.sett ? describe(*measured.sett) : "") + (measured.height ? describe(*measured.height) : "");
}

nlohmann::json to_json(const MeasuredFabric& measured) {
  nlohmann::json document = nlohmann::json::object();
  if (measured.sett) document.update(to_json(*measured.sett));
  if (measured.height) document.update(to_json(*measured.height));
  return document;
}

}  // namespace station
