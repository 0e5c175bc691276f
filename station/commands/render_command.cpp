#include <iostream>

#include "station/cloth/render/render_jobs.h"
#include "station/cloth/render/render_scene.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/ready_name.h"

namespace station {
namespace {

struct RenderArguments {
  std::vector<std::filesystem::path> scenes;
  RenderRequest request;
  bool time = false, memory = false;
  std::string noise;
  OutputOptions output;
};

// Renders into a folder where several pictures are to be made, or where the name has no ending.
std::vector<RenderReport> render(const RenderArguments& arguments, RenderRanks& ranks) {
  RenderRequest request = arguments.request;
  request.noise = parse_noise(arguments.noise).value_or(0);
  request.progress = arguments.output.progress_style();
  const bool is_folder = !request.out.has_extension() || std::filesystem::is_directory(request.out);
  if (arguments.scenes.size() > 1 || is_folder) return render_scenes(arguments.scenes, request, ranks);
  request.scene = arguments.scenes.front();
  return {render_scene(request, ranks)};
}

std::string description(const RenderArguments& arguments, const RenderReport& report) {
  if (report.kept) return report.image + " is there already\n";
  return report.image + "\n" + (arguments.time ? describe_times(report) + describe_noise(report) : "") +
         (arguments.memory ? describe(report.memory) : "");
}

void print(const RenderArguments& arguments, const std::vector<RenderReport>& reports) {
  if (arguments.output.json) {
    nlohmann::json all = nlohmann::json::array();
    for (const RenderReport& report : reports) all.push_back(to_json(report));
    std::cout << (arguments.scenes.size() > 1 ? all : all.front()).dump() << "\n";
  } else if (arguments.time || arguments.memory) {
    for (const RenderReport& report : reports) std::cout << description(arguments, report);
  }
}

}  // namespace

void add_render_command(CLI::App& app) {
  auto arguments = std::make_shared<RenderArguments>();
  RenderRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand(
      "render", "a scene of cloth to a picture; by several processes where mpirun or srun starts them");
  or_ready("scenes", command->add_option("scene", arguments->scenes, "scene file or a ready one's name, or several"))
      ->required();
  command
      ->add_option("--out", request.out,
                   "picture to write: .exr (linear) or .png (display); or a folder: both, named as the scene")
      ->required();
  command->add_option("--spp", request.samples_per_pixel, "samples per pixel")->check(CLI::Range(1, 1 << 20));
  command
      ->add_option("--noise", arguments->noise,
                   "samples where they are needed, until the noise is this share of the brightness (1%) or --spp is "
                   "reached (4096 when left out)")
      ->check([](const std::string& text) { return parse_noise(text) ? "" : "give 0.01% to 100%"; });
  command->add_option("--seed", request.seed, "another number gives another noise")->capture_default_str();
  command->add_option("--threads", request.threads, "processor threads of each process, 0 for all")
      ->check(CLI::Range(0, 4096));
  command
      ->add_option("--checkpoint-every", request.checkpoint_every_s,
                   "seconds after which what there is is stored, so that even a pulled plug loses no more")
      ->check(CLI::Range(0.05, 1e6))
      ->capture_default_str();
  command->add_option("--exposure", request.brightness, "PNG: radiance times this is shown")
      ->check(CLI::PositiveNumber);
  command->add_flag("--png", request.png, "a PNG beside the EXR");
  command->add_flag("--layers", request.layers,
                    "EXR: albedo, normal, depth, cover, thread and yarn of what each pixel shows, as channels");
  command->add_flag("--denoise", request.denoise,
                    "beside it NAME.denoised, smoothed for looking at it; measure in the picture itself");
  command->add_flag("--half", request.half, "EXR: colours in 16 bit");
  command->add_flag("--fresh", request.fresh,
                    "begin again where an interrupted rendering left a checkpoint, or the picture is there");
  command->add_flag("--time", arguments->time, "print how long it took, and how noisy the picture is");
  command->add_flag("--memory", arguments->memory, "print what the scene and the picture take of the memory");
  arguments->output.add_to(*command);
  command->callback([arguments] {
    RenderRanks ranks = RenderRanks::started();
    const std::vector<RenderReport> reports = render(*arguments, ranks);
    if (ranks.first()) print(*arguments, reports);
  });
}

}  // namespace station
