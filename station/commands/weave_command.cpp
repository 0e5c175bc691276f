#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <vector>

#include "renderer/image_file.h"
#include "renderer/weave/woven_patch.h"
#include "station/commands/commands.h"
#include "station/documents/draft_drawing.h"
#include "station/documents/draft_file.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"
#include "station/patch_view.h"

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

// Overlap in percent of the thinner system's radius; 0 where yarns are apart.
double overlap_percent(const YarnPatch& patch, const renderer::Draft& draft) {
  const double radius_mm = std::min(draft.warp.diameter_mm, draft.weft.diameter_mm) / 2;
  return 100 * std::max(0.0, -patch.least_gap_mm) / radius_mm;
}

std::string described(const RelaxedPatch& relaxed, const renderer::Draft& draft) {
  const YarnPatch& patch = relaxed.patch;
  std::string text = patch.name + ": " + std::to_string(ends_in_patch(draft)) + " ends x " +
                     std::to_string(picks_in_patch(draft)) + " picks, " + number("%.3f", patch.period_x_mm) + " x " +
                     number("%.3f mm\n", patch.period_y_mm);
  text +=
      "crimp " + number("warp %.2f %%, ", 100 * patch.crimp_warp) + number("weft %.2f %%\n", 100 * patch.crimp_weft);
  text += number("thickness %.3f mm\n", patch.thickness_mm) + number("cover %.1f %%\n", 100 * patch.cover);
  text += patch.areal_mass_g_m2 > 0 ? number("mass %.1f g/m2\n", patch.areal_mass_g_m2)
                                    : "mass unknown: the draft gives no tex\n";
  text += number("overlap of yarns %.2f %% of the radius\n", overlap_percent(patch, draft));
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
  using renderer::Draft;
  struct Arguments {
    std::string draft, out, drawing, view;
    std::vector<std::function<void(Draft&)>> changes;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("weave", "a weave draft to a periodic patch of yarns");
  command->add_option("--draft", arguments->draft, "draft file (JSON or WIF)")->required();
  command->add_option("--out", arguments->out, "patch file to write")->required();
  command->add_option("--drawing", arguments->drawing, "the draft as weavers draw it, PNG or SVG");
  command->add_option("--view", arguments->view, "the patch from above, in perspective and in section, PNG or EXR");
  // Each stands for a key of the draft file, and wins over it.
  const auto change = [&]<typename T>(const char* name, T& (*key)(Draft&), const char* help) {
    command->add_option_function<T>(
        name,
        [arguments, key](const T& value) {
          arguments->changes.push_back([key, value](Draft& draft) { key(draft) = value; });
        },
        help);
  };
  change.operator()<double>(
      "--warp-pitch", [](Draft& d) -> double& { return d.warp.pitch_mm; }, "mm from end to end");
  change.operator()<double>(
      "--weft-pitch", [](Draft& d) -> double& { return d.weft.pitch_mm; }, "mm from pick to pick");
  change.operator()<double>(
      "--height-scale", [](Draft& d) -> double& { return d.height_scale; },
      "multiplies the heights of the yarns at rest");
  change.operator()<double>(
      "--transverse-modulus", [](Draft& d) -> double& { return d.transverse_modulus_n_mm2; },
      "N/mm^2: yarns flatten where they press each other; 0 = sections as drafted");
  change.operator()<int>(
      "--plies", [](Draft& d) -> int& { return d.plies.count; }, "plies of each yarn");
  change.operator()<double>(
      "--ply-turns", [](Draft& d) -> double& { return d.plies.turns_per_mm; }, "turns of the plies per mm");
  change.operator()<double>(
      "--ply-radius", [](Draft& d) -> double& { return d.plies.radius_mm; }, "mm; 0 = as thick as fit into the yarn");
  change.operator()<double>(
      "--uneven-radius", [](Draft& d) -> double& { return d.unevenness.radius; },
      "deviation of yarns' radii, a share of the radius");
  change.operator()<double>(
      "--uneven-pitch", [](Draft& d) -> double& { return d.unevenness.pitch; },
      "deviation of yarns' places, a share of their room");
  change.operator()<int>(
      "--shades", [](Draft& d) -> int& { return d.unevenness.shades; },
      "threads that take turns at random for each of the draft's");
  change.operator()<double>(
      "--slub-radius", [](Draft& d) -> double& { return d.slubs.radius; },
      "deviation of the radius along each yarn, a share of the radius");
  change.operator()<double>(
      "--slub-twist", [](Draft& d) -> double& { return d.slubs.twist; },
      "deviation of the plies' turns along each yarn, a share of them");
  change.operator()<double>(
      "--slub-length", [](Draft& d) -> double& { return d.slubs.length_mm; },
      "mm: correlation length of both along the yarn");
  change.operator()<double>(
      "--shade-length", [](Draft& d) -> double& { return d.slubs.shade_mm; },
      "mm: mean length of one shade along a yarn; 0 = yarns of one shade");
  change.operator()<std::uint64_t>(
      "--seed", [](Draft& d) -> std::uint64_t& { return d.unevenness.seed; }, "of all that is uneven");
  command->add_flag("--json", arguments->json, "what was measured as JSON, for machines");
  command->callback([arguments] {
    Draft draft = read_draft(arguments->draft);
    for (const auto& change_key : arguments->changes) change_key(draft);
    if (const auto problem = check_draft(draft)) throw std::runtime_error(arguments->draft + ": " + *problem);
    if (!arguments->drawing.empty()) write_drawing(arguments->drawing, draft);
    const RelaxedPatch relaxed = renderer::woven_patch(draft);
    const YarnPatch& patch = relaxed.patch;
    const json document = to_json(patch);
    write_json_file(arguments->out, document);
    if (!arguments->view.empty()) write_patch_view(arguments->view, patch);
    if (arguments->json)
      std::cout << json{{"patch", arguments->out},
                        {"name", patch.name},
                        {"measured", document.at("measured")},
                        {"relaxation", relaxation_json(relaxed.report)}}
                       .dump()
                << "\n";
    else
      std::cout << described(relaxed, draft);
  });
}

}  // namespace station
