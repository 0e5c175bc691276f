#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "station/cloth/preview/cloth_preview.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/weave_options.h"
#include "station/session/results.h"

namespace station {

void add_cloth_command(CLI::App& app) {
  struct ClothArguments {
    ClothPreviewRequest request;
    std::filesystem::path of, warp;
    std::string model = "thread", warp_colour, weft_colour;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ClothArguments>();
  ClothPreviewRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("cloth", "what digitized threads weave into, in pictures");
  or_ready("threads", command->add_option("session", arguments->of,
                                          "session folder with a fitted thread or bundle, or, with --out, a thread or "
                                          "bundle file or a ready thread's name"))
      ->excludes(or_ready("threads", command->add_option("--warp", arguments->warp,
                                                         "thread or bundle file of the warp, or a ready thread's name; "
                                                         "with --weft, instead of a session")));
  add_weave_options(*command, request.cloth);
  command->add_option("--out", request.cloth.out,
                      "folder for a cloth that belongs to no session, with copies of its threads");
  command->add_option("--model", arguments->model, "the session's fitted model that it is woven of: thread or bundle")
      ->check(CLI::IsMember({"thread", "bundle"}))
      ->capture_default_str();
  command->add_option(
      "--warp-colour", arguments->warp_colour,
      "like #c01830, crimson or \"lab(40 60 30)\": only the thread's absorption changes; its own without it");
  command->add_option("--weft-colour", arguments->weft_colour, "likewise");
  std::string shapes;
  for (const std::string& shape : cloth_shapes()) shapes += shape + ", ";
  command
      ->add_option(
          "--shape", request.shapes,
          "what the cloth is made into, one or several: " + shapes + "or a mesh with uv (.obj, .ply, .gltf, .glb)")
      ->check(CLI::IsMember(cloth_shapes()) | CLI::ExistingFile)
      ->capture_default_str();
  command
      ->add_option("--mesh-unit", request.mesh_unit_mm,
                   "millimetres that one unit of the mesh's coordinates is; 1, or 1000 for glTF, without it")
      ->check(CLI::Range(1e-6, 1e6));
  std::string lights;
  for (const std::string& one : cloth_lights()) lights += one + ", ";
  command
      ->add_option("--lights", request.lights,
                   "where light comes from: " + lights + "or a picture of all surroundings (EXR)")
      ->check(CLI::IsMember(cloth_lights()) | CLI::ExistingFile)
      ->capture_default_str();
  command->add_option("--turn", request.view.turn_deg, "degrees by which the camera goes round the cloth")
      ->capture_default_str();
  command->add_option("--tilt", request.view.tilt_deg, "degrees by which it rises")->capture_default_str();
  command->add_option("--light-turn", request.view.light_turn_deg, "likewise, of the lamp")->capture_default_str();
  command->add_option("--light-tilt", request.view.light_tilt_deg, "likewise, of the lamp")->capture_default_str();
  command->add_option("--zoom", request.view.zoom, "how much closer the camera looks")->capture_default_str();
  command->add_option("--size", request.size_px,
                      "the longer side of a picture in pixels, 2362 for 20 cm at 300 dpi; a screen's without it");
  command->add_flag("--quick", request.quick, "smaller pictures of fewer samples");
  arguments->output.add_to(*command);
  command->callback([arguments] {
    ClothPreviewRequest& asked = arguments->request;
    if (!arguments->warp_colour.empty()) asked.cloth.warp_colour = parse_colour(arguments->warp_colour);
    if (!arguments->weft_colour.empty()) asked.cloth.weft_colour = parse_colour(arguments->weft_colour);
    asked.progress_style = arguments->output.progress_style();
    if (!arguments->warp.empty()) arguments->of = arguments->warp;
    if (arguments->of.empty())
      throw std::runtime_error("no thread was given; give a session, a thread's file or name, or --warp (and --weft)");
    weave_thread_of(asked.cloth, arguments->of, arguments->model);
    const nlohmann::json made_of = preview_cloth(asked);
    if (arguments->output.json) {
      std::cout << made_of.dump() << "\n";
      return;
    }
    for (const auto& file : pictures_of_cloth(asked.cloth.out)) std::cout << file.string() << "\n";
  });
}

}  // namespace station
