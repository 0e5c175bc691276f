#include <iostream>

#include "station/cloth/export/export_thread.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"
#include "station/commands/ready_name.h"

namespace station {

void add_export_thread_command(CLI::App& exports) {
  struct ExportThreadArguments {
    ExportThreadRequest request;
    ClothBrdfRequest cloth;
    std::vector<std::string> only;
    OutputOptions output;
  };
  auto arguments = std::make_shared<ExportThreadArguments>();
  ExportThreadRequest& request = arguments->request;
  CLI::App* command = exports.add_subcommand(
      "thread", "the nearest single fiber for Mitsuba and Blender, tables of the scattering, the BRDF of its cloth");
  or_ready("threads", command->add_option("thread", request.thread, "thread file or a ready one's name"))->required();
  command->add_option("--out", request.out, "new folder")->required();
  command->add_option("--only", arguments->only, "some of mitsuba, blender, csv, numpy, merl")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kThreadExports.begin(), kThreadExports.end())));
  CLI::Option* draft =
      or_ready("drafts", command->add_option("--draft", arguments->cloth.draft,
                                             "draft of the cloth whose BRDF is measured for merl, or a ready one's "
                                             "name; scaled to the thread"));
  command
      ->add_flag("--allow-anisotropic", arguments->cloth.allow_anisotropic,
                 "merl even of a cloth that changes when it is turned: the mean over all turns")
      ->needs(draft);
  command->add_option("--samples", arguments->cloth.samples_per_cell, "paths for each cell of the BRDF")
      ->check(CLI::Range(4, 4096))
      ->needs(draft)
      ->capture_default_str();
  arguments->output.add_to(*command);
  command->callback([arguments] {
    ExportThreadRequest& asked = arguments->request;
    asked.only = {arguments->only.begin(), arguments->only.end()};
    if (!arguments->cloth.draft.empty()) asked.cloth = arguments->cloth;
    asked.progress_style = arguments->output.progress_style();
    const ThreadExportReport report = export_thread(asked);
    if (arguments->output.json)
      std::cout << to_json(report).dump() << "\n";
    else if (!arguments->output.quiet)
      std::cout << describe(report);
  });
}

}  // namespace station
