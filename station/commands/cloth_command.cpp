#include <iostream>

#include "station/cloth/cloth_preview.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/session/results.h"

namespace station {

void add_cloth_command(CLI::App& app) {
  struct ClothArguments {
    ClothPreviewRequest request;
    std::string warp_colour, weft_colour;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ClothArguments>();
  ClothPreviewRequest& request = arguments->request;
  CLI::App* command = app.add_subcommand("cloth", "what a session's thread weaves into: a swatch and a cylinder");
  command->add_option("session", request.session, "session folder with a fitted thread or bundle")->required();
  command->add_option("--draft", request.draft, "draft (JSON or WIF); scaled to the thread")->required();
  command->add_option("--model", request.model, "the fitted model that it is woven of: thread or bundle")
      ->check(CLI::IsMember({"thread", "bundle"}))
      ->capture_default_str();
  command->add_option("--warp-colour", arguments->warp_colour,
                      "like #c01830: only the thread's absorption changes; its own without it");
  command->add_option("--weft-colour", arguments->weft_colour, "likewise");
  command->add_flag("--quick", request.quick, "smaller pictures");
  arguments->output.add_to(*command);
  command->callback([arguments] {
    ClothPreviewRequest& asked = arguments->request;
    if (!arguments->warp_colour.empty()) asked.warp_colour = parse_colour(arguments->warp_colour);
    if (!arguments->weft_colour.empty()) asked.weft_colour = parse_colour(arguments->weft_colour);
    asked.progress_style = arguments->output.progress_style();
    const nlohmann::json made_of = preview_cloth(asked);
    if (arguments->output.json) {
      std::cout << made_of.dump() << "\n";
      return;
    }
    for (const auto& file : cloth_pictures(asked.session)) std::cout << file.string() << "\n";
  });
}

}  // namespace station
