#include <cstdio>
#include <iostream>

#include "renderer/image_file.h"
#include "station/commands/commands.h"
#include "station/compare/compare_pictures.h"
#include "station/documents/calibration_file.h"

namespace station {
namespace {

struct Arguments {
  std::string photograph, rendering, mask, out, calibration;
  CompareOptions options;
  bool same_unit = false, json = false;
};

nlohmann::json to_json(const HighlightProfile& profile) {
  return {{"peak_px", profile.peak_px}, {"width_px", profile.width_px}, {"brightness", profile.brightness}};
}

void run(Arguments& arguments) {
  const cv::Mat3f photograph = renderer::read_exr(arguments.photograph),
                  rendering = renderer::read_exr(arguments.rendering);
  const cv::Mat1b mask = arguments.mask.empty() ? cv::Mat1b() : renderer::read_png_grey(arguments.mask);
  CompareOptions& options = arguments.options;
  options.fit_scale = !arguments.same_unit;
  if (!arguments.calibration.empty())
    options.linear_srgb_from_camera = read_calibration(arguments.calibration).linear_srgb_from_camera;
  const Comparison found = compare_pictures(photograph, rendering, mask, options);
  if (!arguments.out.empty())
    renderer::write_png(arguments.out, comparison_picture(photograph, rendering, mask, options));
  if (arguments.json) {
    std::cout << nlohmann::json{{"scale", found.scale},
                                {"blocks", found.blocks},
                                {"mean_delta_e_2000", found.mean_delta_e},
                                {"median_delta_e_2000", found.median_delta_e},
                                {"delta_e_2000_95", found.delta_e_95},
                                {"relative_rmse", found.relative_rmse},
                                {"profile_correlation", found.profile_correlation},
                                {"photograph", to_json(found.photograph)},
                                {"rendering", to_json(found.rendering)}}
                     .dump()
              << "\n";
    return;
  }
  std::printf(
      "colour difference (CIEDE2000): mean %.2f, median %.2f, 95 %% below %.2f, over %d blocks\n"
      "relative RMSE %.1f %%, the rendering scaled by %.4g\n"
      "highlight: photograph at column %.0f, %.0f px wide; rendering at column %.0f, %.0f px wide; profiles "
      "correlate by %.3f\n",
      found.mean_delta_e, found.median_delta_e, found.delta_e_95, found.blocks, 100 * found.relative_rmse,
      found.scale, found.photograph.peak_px, found.photograph.width_px, found.rendering.peak_px,
      found.rendering.width_px, found.profile_correlation);
}

}  // namespace

void add_compare_command(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("compare", "a photograph against a rendering of the same view");
  command->add_option("photograph", arguments->photograph, "linear EXR, as develop writes it")->required();
  command->add_option("rendering", arguments->rendering, "linear EXR, as render writes it")->required();
  command->add_option("--mask", arguments->mask, "PNG, white where they are compared");
  command->add_option("--calibration", arguments->calibration,
                      "for the camera's colours; without it they are sRGB's");
  command->add_option("--block", arguments->options.block_px, "pixels of the blocks whose averages are compared")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--same-unit", arguments->same_unit, "do not scale the rendering to the photograph");
  command->add_option("--out", arguments->out, "picture of both and their difference (PNG)");
  command->add_flag("--json", arguments->json, "as JSON, with the highlight's profiles");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace station
