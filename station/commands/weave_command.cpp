#include <algorithm>
#include <cstdint>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "renderer/picture/image_file.h"
#include "station/cloth/patch_picture.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/ready_name.h"
#include "station/documents/draft_drawing.h"
#include "station/documents/draft_file.h"
#include "station/documents/number_text.h"
#include "station/documents/patch_file.h"
#include "station/documents/reader.h"
#include "station/output/interrupt.h"
#include "station/output/watched_work.h"

namespace station {
namespace {

using nlohmann::json;

using renderer::Draft;
using renderer::RelaxationReport;
using renderer::RelaxedPatch;
using renderer::YarnPatch;

// The overlap in percent of the thinner system's radius; 0 where yarns are apart.
double overlap_percent(const YarnPatch& patch, const Draft& draft) {
  const double radius_mm = std::min(draft.warp.diameter_mm, draft.weft.diameter_mm) / 2;
  return 100 * std::max(0.0, -patch.least_gap_mm) / radius_mm;
}

std::string described(const RelaxedPatch& relaxed, const Draft& draft) {
  const YarnPatch& patch = relaxed.patch;
  std::string text = patch.name + ": " + std::to_string(ends_in_patch(draft)) + " ends x " +
                     std::to_string(picks_in_patch(draft)) + " picks, " + formatted("%.3f", patch.period_x_mm) + " x " +
                     formatted("%.3f mm\n", patch.period_y_mm);
  text += "crimp " + formatted("warp %.2f %%, ", 100 * patch.crimp_warp) +
          formatted("weft %.2f %%\n", 100 * patch.crimp_weft);
  text += formatted("thickness %.3f mm\n", patch.thickness_mm) + formatted("cover %.1f %%\n", 100 * patch.cover);
  text += patch.areal_mass_g_m2 > 0 ? formatted("mass %.1f g/m2\n", patch.areal_mass_g_m2)
                                    : "mass unknown: the draft gives no tex\n";
  text += formatted("overlap of yarns %.2f %% of the radius\n", overlap_percent(patch, draft));
  if (patch.height_scale != 1) text += formatted("heights scaled by %g\n", patch.height_scale);
  if (relaxed.report.jammed)
    text += "note: yarns jam in this sett" +
            formatted(" (they part by %.1f %% where they cross)", 100 * relaxed.report.crown_gap) +
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

// An option that stands for a key of the draft file and wins over it.
template <typename T>
struct KeyOption {
  const char* name;
  T& (*key)(Draft&);
  const char* help;
};

const KeyOption<double> kNumbers[] = {
    {"--warp-pitch", [](Draft& d) -> double& { return d.warp.pitch_mm; }, "mm from end to end"},
    {"--weft-pitch", [](Draft& d) -> double& { return d.weft.pitch_mm; }, "mm from pick to pick"},
    {"--height-scale", [](Draft& d) -> double& { return d.height_scale; },
     "multiplies the heights of the yarns at rest"},
    {"--transverse-modulus", [](Draft& d) -> double& { return d.transverse_modulus_n_mm2; },
     "N/mm^2: yarns flatten where they press each other; 0 = sections as drafted"},
    {"--ply-turns", [](Draft& d) -> double& { return d.plies.turns_per_mm; }, "turns of the plies per mm"},
    {"--ply-radius", [](Draft& d) -> double& { return d.plies.radius_mm; }, "mm; 0 = as thick as fit into the yarn"},
    {"--uneven-radius", [](Draft& d) -> double& { return d.unevenness.radius; },
     "deviation of yarns' radii, a share of the radius"},
    {"--uneven-pitch", [](Draft& d) -> double& { return d.unevenness.pitch; },
     "deviation of yarns' places, a share of their room"},
    {"--slub-radius", [](Draft& d) -> double& { return d.slubs.radius; },
     "deviation of the radius along each yarn, a share of the radius"},
    {"--slub-twist", [](Draft& d) -> double& { return d.slubs.twist; },
     "deviation of the plies' turns along each yarn, a share of them"},
    {"--slub-length", [](Draft& d) -> double& { return d.slubs.length_mm; },
     "mm: correlation length of both along the yarn"},
    {"--shade-length", [](Draft& d) -> double& { return d.slubs.shade_mm; },
     "mm: mean length of one shade along a yarn; 0 = yarns of one shade"},
};

const KeyOption<int> kCounts[] = {
    {"--plies", [](Draft& d) -> int& { return d.plies.count; }, "plies of each yarn"},
    {"--shades", [](Draft& d) -> int& { return d.unevenness.shades; },
     "threads that take turns at random for each of the draft's"},
};

const KeyOption<std::uint64_t> kSeeds[] = {
    {"--seed", [](Draft& d) -> std::uint64_t& { return d.unevenness.seed; }, "of all that is uneven"},
};

void write_drawing(const std::string& file, const Draft& draft, const ThreadColours& colours) {
  const std::string kind = std::filesystem::path(file).extension().string();
  if (kind == ".svg")
    write_text_file(file, draw_draft_svg(draft, colours));
  else if (kind == ".png")
    renderer::write_png(file, draw_draft(draft, colours));
  else
    throw std::runtime_error(file + ": a drawing is a .png or a .svg file; change the name");
}

}  // namespace

void add_weave_command(CLI::App& app) {
  struct WeaveArguments {
    std::string draft, out, drawing, view;
    std::vector<std::filesystem::path> threads;
    std::vector<std::function<void(Draft&)>> changes;
    OutputOptions output;
  };
  auto arguments = std::make_shared<WeaveArguments>();
  CLI::App* command = app.add_subcommand("weave", "a weave draft to a periodic patch of yarns");
  or_ready("drafts", command->add_option("--draft", arguments->draft, "draft file (JSON or WIF) or a ready one's name"))
      ->required();
  command->add_option("--out", arguments->out, "patch file to write")->required();
  command->add_option("--drawing", arguments->drawing, "the draft as weavers draw it, PNG or SVG");
  command->add_option("--view", arguments->view, "the patch from above, in perspective and in section, PNG or EXR");
  or_ready("threads", command->add_option("--threads", arguments->threads,
                                          "thread files or ready threads' names, in the order of the draft's threads: "
                                          "drawing and view have their colours"));
  const auto add_keys = [&](const auto& options) {
    for (const auto& option : options)
      command->add_option_function<std::decay_t<decltype(option.key(std::declval<Draft&>()))>>(
          option.name,
          [arguments, key = option.key](const auto& value) {
            arguments->changes.push_back([key, value](Draft& draft) { key(draft) = value; });
          },
          option.help);
  };
  add_keys(kNumbers), add_keys(kCounts), add_keys(kSeeds);
  arguments->output.add_to(*command);
  command->callback([arguments] {
    Draft draft = read_draft(arguments->draft);
    for (const auto& change_key : arguments->changes) change_key(draft);
    if (const auto problem = check_draft(draft)) throw std::runtime_error(arguments->draft + ": " + *problem);
    const ThreadColours colours = colours_of_threads(arguments->threads);
    if (!arguments->drawing.empty()) write_drawing(arguments->drawing, draft, colours);
    ProgressDisplay progress("weave", arguments->output.progress_style());
    watch_interrupts();
    const RelaxedPatch relaxed = weave_watched(draft, progress);
    const YarnPatch& patch = relaxed.patch;
    const json document = to_json(patch);
    write_json_file(arguments->out, document);
    if (!arguments->view.empty()) write_patch_picture(arguments->view, patch, colours);
    if (arguments->output.json)
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
