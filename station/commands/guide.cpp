#include "station/commands/guide.h"

#include <sstream>
#include <string>

#include "station/data/data_folder.h"

namespace station {
namespace {

constexpr const char* kParts = "Commands";  // the heading of a command's own commands

struct Guide {
  const char* command;
  const char* group;    // of a command's own commands: kParts
  const char* example;  // "" where only its own commands are run; DATA is the folder of what comes with the program
};

constexpr Guide kGuides[] = {
    {"demo", "See what it does", "demo --quick --out demo"},

    {"devices", "Set up a bench", "devices"},
    {"rig", "Set up a bench", ""},
    {"rig new", kParts, "rig new --like DATA/rigs/simulated.json --out new_rig.json"},
    {"rig check", kParts, "rig check DATA/rigs/simulated.json"},
    {"target", "Set up a bench", "target --rig DATA/rigs/simulated.json --out targets"},
    {"check", "Set up a bench", "check --rig DATA/rigs/simulated.json"},
    {"home", "Set up a bench", "home --rig DATA/rigs/simulated.json"},
    {"preview", "Set up a bench", "preview --rig DATA/rigs/simulated.json --out live.jpg --frames 3"},
    {"turntable", "Set up a bench", ""},
    {"turntable set-up", kParts, "turntable set-up --rig DATA/rigs/simulated_wire_grbl.json"},
    {"simulate-hardware", "Set up a bench", "simulate-hardware --rig DATA/rigs/simulated_wire_grbl.json"},
    {"calibrate", "Set up a bench", "calibrate --rig rig.json --out calibration"},
    {"calibrate camera", kParts,
     "calibrate camera --images photographs --board DATA/boards/chessboard_6x9.json --out lens.json"},

    {"serve", "Photograph spools", "serve --rig DATA/rigs/simulated.json --workspace lab --port 0"},
    {"plan", "Photograph spools", "plan --rig DATA/rigs/simulated.json --out plan.json"},
    {"capture", "Photograph spools",
     "capture --rig rig.json --calibration calibration --spool DATA/spools/silk_red.json --out session --record"},
    {"import", "Photograph spools", "import --views pictures.json --out by_hand"},
    {"replay", "Photograph spools", "replay session --out again"},
    {"verify", "Photograph spools", "verify session"},

    {"develop", "Digitize threads", "develop session"},
    {"invert", "Digitize threads", "invert session"},
    {"report", "Digitize threads", "report session"},
    {"library", "Digitize threads", ""},
    {"library add", kParts, "library add session"},
    {"library list", kParts, "library list silk"},
    {"library show", kParts, "library show 1"},
    {"library edit", kParts, "library edit 1 --lot B7"},
    {"library export", kParts, "library export 1 --out thread_1"},
    {"library remove", kParts, "library remove 1"},
    {"library restore", kParts, "library restore 1"},

    {"weave", "Predict cloth", "weave --draft twill_2_2 --out twill.json --view twill.png"},
    {"cloth", "Predict cloth", "cloth session --draft twill_2_2 --quick"},
    {"look", "Predict cloth", "look silk_red --weft silk_gold --draft plain --spp 1 --out looked"},
    {"render", "Predict cloth", "render DATA/scenes/plain_swatch.json --out swatch.exr --spp 4 --png"},
    {"pattern", "Predict cloth",
     "pattern --image DATA/motifs/flower.jpg --thread silk_gold --draft satin_5 --ends 40 --curves-only --out flower"},
    {"embroider", "Predict cloth", "embroider DATA/motifs/leaf.svg --thread silk_blue --out leaf.png --spp 4"},
    {"predict", "Predict cloth", "predict cloth_session --spp 4"},
    {"compare", "Predict cloth", "compare photograph.exr swatch.exr --out difference.png"},

    {"export", "Use them in other programs", ""},
    {"export thread", kParts, "export thread silk_red --out silk_red_exported --only mitsuba,csv"},
    {"export cloth", kParts, "export cloth plain_swatch --out plain_cloth --size 64 --spp 4 --only textures"},

    {"scatter", "Study the models", ""},
    {"scatter simulate", kParts, "scatter simulate --theta 30 --absorption 0.2 --configurations 10 --out theta_30.csv"},
    {"scatter fit", kParts, "scatter fit --in theta_30.csv --out fit.json"},
    {"scatter eval", kParts,
     "scatter eval --model thread --parameters DATA/threads/silk_red.json --in directions.csv --out values.csv"},
    {"scatter plot", kParts, "scatter plot --rays 100 --configurations 10 --out plots"},
    {"scatter prior", kParts, "scatter prior --threads 2 --configurations 5 --out prior.json"},
    {"scatter exits", kParts, "scatter exits --configurations 5 --out exits.json"},
    {"validate", "Study the models",
     "validate --rig rig.json --spool DATA/spools/packed_silk_red_20.json --folds 0 --model fiber --spp 1 --out "
     "validated"},
    {"validate-cloth", "Study the models",
     "validate-cloth --rig rig.json --warp DATA/spools/packed_silk_red_20.json "
     "--weft DATA/spools/packed_silk_red_20.json --draft DATA/drafts/plain.json --model fiber --paths 32 "
     "--photograph-spp 1 --width 64 --spp 1 --out compared"},
    {"recover", "Study the models",
     "recover --rig rig.json --spool DATA/spools/silk_blue.json --thread DATA/threads/silk_blue.json --draws 0 --spp 8 "
     "--paths 64 256"},
    {"reproduce", "Study the models", "reproduce 5 --quick --out figures"},

    {"batch", "Many at once", "batch DATA/batches/ready_threads.json --out batch"},
    {"batch status", kParts, "batch status batch"},
    {"batch report", kParts, "batch report batch"},
    {"batch cancel", kParts, "batch cancel batch"},
    {"batch task", kParts, "batch task batch --step tables --item 0"},

    {"upgrade", "Use this program", "upgrade session"},
    {"completion", "Use this program", "completion bash"},
};

CLI::App& command_of(CLI::App& app, const std::string& words) {
  CLI::App* at = &app;
  std::istringstream names(words);
  for (std::string name; names >> name;) at = at->get_subcommand(name);
  return *at;
}

std::string with_data(std::string text) {
  const std::string kData = "DATA", folder = data_folder_name();
  for (std::size_t at = 0; (at = text.find(kData + "/", at)) != std::string::npos; at += folder.size())
    text.replace(at, kData.size(), folder);
  return text;
}

}  // namespace

void add_guide(CLI::App& app) {
  for (const Guide& guide : kGuides) {
    CLI::App& command = command_of(app, guide.command);
    command.group(guide.group);
    if (*guide.example) command.footer("Example:\n  " + app.get_name() + " " + with_data(guide.example));
  }
}

}  // namespace station
