#include <algorithm>
#include <cstdio>
#include <iostream>

#include "renderer/image_file.h"
#include "renderer/weave/relaxation.h"
#include "station/commands/commands.h"
#include "station/documents/draft_drawing.h"
#include "station/documents/draft_file.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"

namespace station {
namespace {

using nlohmann::json;

using renderer::RelaxationReport;
using renderer::RelaxedPatch;
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

std::string described(const RelaxedPatch& relaxed) {
  const YarnPatch& patch = relaxed.patch;
  const auto ends =
      std::count_if(patch.yarns.begin(), patch.yarns.end(), [](const renderer::Yarn& y) { return y.warp; });
  const auto picks = static_cast<std::ptrdiff_t>(patch.yarns.size()) - ends;
  std::string text = patch.name + ": " + std::to_string(ends) + " ends x " + std::to_string(picks) + " picks, " +
                     number("%.3f", patch.period_x_mm) + " x " + number("%.3f mm\n", patch.period_y_mm);
  text +=
      "crimp " + number("warp %.2f %%, ", 100 * patch.crimp_warp) + number("weft %.2f %%\n", 100 * patch.crimp_weft);
  text += number("thickness %.3f mm\n", patch.thickness_mm) + number("cover %.1f %%\n", 100 * patch.cover);
  text += patch.areal_mass_g_m2 > 0 ? number("mass %.1f g/m2\n", patch.areal_mass_g_m2)
                                    : "mass unknown: the draft gives no tex\n";
  text += number("overlap of yarns %.2f %% of the radius\n", overlap_percent(patch));
  if (patch.height_scale != 1) text += number("heights scaled by %g\n", patch.height_scale);
  if (relaxed.report.jammed)
    text += "note: yarns jam in this sett" +
            number(" (they part by %.1f %% where they cross)", 100 * relaxed.report.crown_gap) +
            "; open it or take thinner yarns\n";
  else if (patch.height_scale < 1)
    text += "note: yarns overlap because the heights are scaled down\n";
  return text;
}

json relaxation_json(const RelaxationReport& report) {
  return {{"converged", report.converged},    {"gradient", report.gradient},   {"overlap", report.overlap},
          {"jammed", report.jammed},          {"crown_gap", report.crown_gap}, {"newton_steps", report.newton_steps},
          {"energy_n_mm", report.energy_n_mm}};
}

// A patch that is not the cloth of its draft is not written.
void check_relaxed(const RelaxedPatch& relaxed, const std::string& draft) {
  if (!relaxed.report.as_drafted)
    throw std::runtime_error(draft +
                             ": yarns slipped past each other on the way to rest, so the cloth is not as drafted; "
                             "open the sett, take thinner yarns or more tension");
  if (!relaxed.report.converged)
    throw std::runtime_error(draft + ": yarns did not come to rest (largest force " +
                             number("%.1e", relaxed.report.gradient) +
                             " of the pull on them); open the sett, take thinner yarns or more tension");
}

void write_drawing(const std::string& file, const renderer::Draft& draft) {
  const std::string kind = std::filesystem::path(file).extension().string();
  if (kind == ".svg")
    write_text_file(file, draw_draft_svg(draft));
  else if (kind == ".png")
    renderer::write_png(file, draw_draft(draft));
  else
    throw std::runtime_error(file + ": a drawing is a .png or a .svg file; change the name");
}

}  // namespace

void add_weave_command(CLI::App& app) {
  struct Arguments {
    std::string draft, out, drawing;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("weave", "a weave draft to a periodic patch of yarns");
  command->add_option("--draft", arguments->draft, "draft file (JSON or WIF)")->required();
  command->add_option("--out", arguments->out, "patch file to write")->required();
  command->add_option("--drawing", arguments->drawing, "the draft as weavers draw it, PNG or SVG");
  command->add_flag("--json", arguments->json, "what was measured as JSON, for machines");
  command->callback([arguments] {
    const renderer::Draft draft = read_draft(arguments->draft);
    if (!arguments->drawing.empty()) write_drawing(arguments->drawing, draft);
    const RelaxedPatch relaxed = renderer::relax(draft);
    check_relaxed(relaxed, arguments->draft);
    const YarnPatch& patch = relaxed.patch;
    const json document = to_json(patch);
    write_json_file(arguments->out, document);
    if (arguments->json)
      std::cout << json{{"patch", arguments->out},
                        {"name", patch.name},
                        {"measured", document.at("measured")},
                        {"relaxation", relaxation_json(relaxed.report)}}
                       .dump()
                << "\n";
    else
      std::cout << described(relaxed);
  });
}

}  // namespace station
