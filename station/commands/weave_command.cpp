#include <algorithm>
#include <cstdio>
#include <iostream>

#include "station/commands/commands.h"
#include "station/documents/draft_file.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using renderer::YarnPatch;

std::string number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// Overlap in percent of the thinnest yarn's radius; 0 where yarns are apart.
double overlap_percent(const YarnPatch& patch) {
  const auto thinner = [](const renderer::Yarn& a, const renderer::Yarn& b) { return a.radius_mm < b.radius_mm; };
  const double radius_mm = std::min_element(patch.yarns.begin(), patch.yarns.end(), thinner)->radius_mm;
  return 100 * std::max(0.0, -patch.least_gap_mm) / radius_mm;
}

std::string described(const YarnPatch& patch) {
  const auto ends =
      std::count_if(patch.yarns.begin(), patch.yarns.end(), [](const renderer::Yarn& y) { return y.warp; });
  const auto picks = static_cast<std::ptrdiff_t>(patch.yarns.size()) - ends;
  std::string text = patch.name + ": " + std::to_string(ends) + " ends x " + std::to_string(picks) + " picks, " +
                     number("%.3f", patch.period_x_mm) + " x " + number("%.3f mm\n", patch.period_y_mm);
  text +=
      "crimp " + number("warp %.2f %%, ", 100 * patch.crimp_warp) + number("weft %.2f %%\n", 100 * patch.crimp_weft);
  text += number("thickness %.3f mm\n", patch.thickness_mm) + number("cover %.1f %%\n", 100 * patch.cover);
  text += number("overlap of yarns %.2f %% of the radius\n", overlap_percent(patch));
  if (patch.height_scale != 1) text += number("heights scaled by %g\n", patch.height_scale);
  constexpr double kFitError = 2;  // percent; what the splines themselves may miss
  if (overlap_percent(patch) > kFitError)
    text += patch.height_scale < 1
                ? "note: yarns overlap because the heights are scaled down\n"
                : "note: yarns overlap because round yarns jam in this sett; open it or take thinner yarns\n";
  return text;
}

}  // namespace

void add_weave_command(CLI::App& app) {
  struct Arguments {
    std::string draft, out;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("weave", "a weave draft to a periodic patch of yarns");
  command->add_option("--draft", arguments->draft, "draft file")->required();
  command->add_option("--out", arguments->out, "patch file to write")->required();
  command->add_flag("--json", arguments->json, "what was measured as JSON, for machines");
  command->callback([arguments] {
    const YarnPatch patch = renderer::initial_patch(read_draft(arguments->draft));
    const nlohmann::json document = to_json(patch);
    write_json_file(arguments->out, document);
    if (arguments->json)
      std::cout << nlohmann::json{{"patch", arguments->out},
                                  {"name", patch.name},
                                  {"measured", document.at("measured")}}
                       .dump()
                << "\n";
    else
      std::cout << described(patch);
  });
}

}  // namespace station
