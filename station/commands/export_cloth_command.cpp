#include <iostream>

#include "station/cloth/export/export_cloth.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/ready_name.h"

namespace station {

void add_export_cloth_command(CLI::App& export_app) {
  struct ExportClothArguments {
    ExportClothRequest request;
    std::vector<ClothExport> only;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ExportClothArguments>();
  ExportClothRequest& request = arguments->request;
  CLI::App* command = export_app.add_subcommand("cloth", "a cloth as tileable textures, glTF and U3M");
  CLI::Option* scene = or_ready(
      "scenes", command->add_option("scene", request.scene, "scene file with one flat cloth, or a ready one's name"));
  CLI::Option* draft = or_ready("drafts", command->add_option("--draft", request.draft,
                                                              "instead of a scene: a draft, or a ready one's name"))
                           ->excludes(scene);
  CLI::Option* warp = or_ready(
      "threads",
      command->add_option("--warp", request.warp, "with --draft: thread file of the warp, or a ready one's name"));
  CLI::Option* weft = or_ready("threads", command->add_option("--weft", request.weft, "likewise, of the weft"));
  draft->needs(warp)->needs(weft);
  warp->needs(draft);
  weft->needs(draft);
  command->add_option("--out", request.out, "folder to make")->required();
  command->add_option("--size", request.size_px, "pixels of the textures' longer side, which is one period")
      ->check(CLI::Range(kLeastExportSize, kMostExportSize))
      ->capture_default_str();
  command->add_option("--spp", request.samples_per_texel, "samples per texel")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  command->add_option("--only", arguments->only, "what to write: textures, gltf, u3m; all without this")
      ->delimiter(',')
      ->transform(CLI::CheckedTransformer(std::map<std::string, ClothExport>{
          {"textures", ClothExport::textures}, {"gltf", ClothExport::gltf}, {"u3m", ClothExport::u3m}}));
  command->add_option("--seed", request.seed, "another number gives another noise")->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments, command, scene, draft] {
    ExportClothRequest& asked = arguments->request;
    if (scene->count() + draft->count() == 0)
      throw CLI::RequiredError(command->get_display_name() + ": a scene, or --draft with --warp and --weft");
    if (!arguments->only.empty()) asked.formats = {arguments->only.begin(), arguments->only.end()};
    asked.progress = arguments->output.progress_style();
    const ExportClothReport report = export_cloth(asked);
    std::cout << (arguments->output.json ? to_json(report).dump() + "\n" : describe(report));
  });
}

}  // namespace station
