#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "station/commands/commands.h"
#include "station/output/compare/compare_files.h"

namespace station {
namespace {

void print(const Comparison& found) {
  std::printf(
      "colour difference (CIEDE2000): mean %.2f, median %.2f, 95 %% below %.2f, over %d blocks\n"
      "relative RMSE %.1f %%, the rendering scaled by %.4g\n"
      "highlight: photograph at column %.0f, %.0f px wide; rendering at column %.0f, %.0f px wide; profiles "
      "correlate by %.3f\n",
      found.mean_delta_e, found.median_delta_e, found.delta_e_95, found.blocks, 100 * found.relative_rmse, found.scale,
      found.photograph.peak_px, found.photograph.width_px, found.rendering.peak_px, found.rendering.width_px,
      found.profile_correlation);
}

}  // namespace

void add_compare_command(CLI::App& app) {
  struct CompareArguments {
    CompareRequest request;
    bool same_unit = false, json = false;
  };
  auto arguments = std::make_shared<CompareArguments>();
  CompareRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("compare", "a photograph against a rendering of the same view");
  command->add_option("photograph", request.photograph, "linear EXR, as develop writes it")->required();
  command->add_option("rendering", request.rendering, "linear EXR, as render writes it")->required();
  command->add_option("--mask", request.mask, "PNG, white where they are compared");
  command->add_option("--calibration", request.calibration, "for the camera's colours; without it they are sRGB's");
  command->add_option("--block", request.options.block_px, "pixels of the blocks whose averages are compared")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--same-unit", arguments->same_unit, "do not scale the rendering to the photograph");
  command->add_option("--out", request.picture, "picture of both and their difference (PNG)");
  command->add_flag("--json", arguments->json, "as JSON, with the highlight's profiles");
  command->callback([arguments] {
    arguments->request.options.fit_scale = !arguments->same_unit;
    const Comparison found = compare_files(arguments->request);
    if (arguments->json)
      std::cout << to_json(found).dump() << "\n";
    else
      print(found);
  });
}

}  // namespace station
