#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "station/cloth/measure_fabric.h"
#include "station/cloth/predict_fabric.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/ready_name.h"
#include "station/documents/draft_file.h"
#include "station/documents/number_text.h"
#include "station/documents/reader.h"

namespace station {
namespace {

void print(const PredictedView& view) {
  const Comparison& found = view.comparison;
  const std::string scaled =
      found.scale == 1 ? "" : ", compared " + number_text(found.scale, 3) + " times as bright as that";
  std::printf(
      "%s: colour difference (CIEDE2000) mean %.2f, 95 %% below %.2f, over %d blocks of %d px; relative RMSE %.1f "
      "%%; predicted %.3f %.3f %.3f times as bright as photographed (red, green, blue)%s; highlight photographed at "
      "column %.0f, predicted at %.0f\n"
      "  %s\n",
      view.view.c_str(), found.mean_delta_e, found.delta_e_95, found.blocks, view.block_px, 100 * found.relative_rmse,
      found.brightness[0], found.brightness[1], found.brightness[2], scaled.c_str(), found.photograph.peak_px,
      found.rendering.peak_px, view.beside.c_str());
}

}  // namespace

void add_predict_command(CLI::App& app) {
  struct PredictArguments {
    PredictRequest request;
    MeasureFabricRequest measure{.sett = false};
    std::filesystem::path draft;
    OutputOptions output;
  };
  auto arguments = std::make_shared<PredictArguments>();
  PredictRequest& request = arguments->request;
  SaidFabric& cloth = request.cloth;
  CLI::App* command =
      app.add_subcommand("predict", "what a cloth on the cylinder should look like, beside its photographs");
  command->add_option("session", cloth.session, "developed session of a cloth (capture --spool FABRIC)")->required();
  command->add_option("--fabric", cloth.fabric, "fabric file whose weave is predicted instead of the session's own");
  or_ready("threads", command->add_option("--warp", cloth.warp,
                                          "session of the warp's thread, a file of its model or a ready thread's name, "
                                          "instead of what the fabric says"));
  or_ready("threads", command->add_option("--weft", cloth.weft, "likewise, of the weft"));
  command->add_option("--model", cloth.model, "which of the sessions' fitted models")
      ->check(CLI::IsMember({"thread", "bundle", "fiber", "yarn"}))
      ->capture_default_str();
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  command->add_option("--seed", request.seed, "of the paths")->capture_default_str();
  command->add_flag("--fit-scale", request.fit_scale,
                    "compare colours after a scale that makes the prediction as bright as its photograph");
  command->add_flag("--sett", arguments->measure.sett,
                    "predict nothing: ends and picks per cm by the repeat that the photographs show");
  command->add_flag("--height", arguments->measure.height,
                    "compare no colours: how far the yarns stand out, by the width of the highlight");
  command->add_option("--draft-out", arguments->draft,
                      "with --sett or --height: the weave's draft with these, to write");
  arguments->output.add_to(*command);
  command->callback([=] {
    arguments->request.progress_style = arguments->output.progress_style();
    MeasureFabricRequest& measure = arguments->measure;
    if (!arguments->draft.empty() && !measure.sett && !measure.height)
      throw std::runtime_error(
          "--draft-out is for a draft of what was measured; give --sett, --height or both with it");
    if (measure.sett || measure.height) {
      const PredictRequest& asked = arguments->request;
      measure.cloth = asked.cloth, measure.progress_style = asked.progress_style, measure.seed = asked.seed;
      if (command->count("--spp") > 0) measure.samples_per_pixel = asked.samples_per_pixel;
      const MeasuredFabric measured = measure_fabric(measure);
      if (!arguments->draft.empty()) write_json_file(arguments->draft, to_json(measured.draft));
      if (arguments->output.json)
        std::cout << to_json(measured).dump() << "\n";
      else if (!arguments->output.quiet)
        std::cout << describe(measured);
      return;
    }
    nlohmann::json views = nlohmann::json::array();
    for (const PredictedView& view : predict_fabric(arguments->request))
      if (arguments->output.json)
        views.push_back(to_json(view));
      else if (!arguments->output.quiet)
        print(view);
    if (arguments->output.json) std::cout << views.dump() << "\n";
  });
}

}  // namespace station
