#include <iostream>
#include <stdexcept>

#include "station/bench/set_up/new_rig.h"
#include "station/bench/set_up/rig_review.h"
#include "station/commands/commands.h"
#include "station/commands/output_options.h"

namespace station {
namespace {

struct NewArguments {
  NewRigRequest request;
  OutputOptions output;
};

void make(const NewArguments& arguments) {
  NewRigRequest request = arguments.request;
  const auto person = asked_person(arguments.output.json);
  request.asked = person.get();
  request.progress_style = arguments.output.progress_style();
  const std::vector<std::string> said = make_rig(request);
  if (arguments.output.json) {
    std::cout << nlohmann::json{{"rig", request.out.string()}, {"said", said}}.dump() << "\n";
  } else if (!arguments.output.quiet) {
    for (const std::string& sentence : said) std::cout << sentence << "\n";
    std::cout << "rig file: " << request.out.string() << "\n";
  }
}

void review(const std::filesystem::path& file, bool as_json) {
  const std::vector<RigRemark> remarks = review_rig(file);
  nlohmann::json list = nlohmann::json::array();
  std::size_t faults = 0;
  for (const RigRemark& remark : remarks) {
    faults += remark.must_be_mended;
    list.push_back({{"must_be_mended", remark.must_be_mended}, {"sentence", remark.sentence}});
    if (!as_json) std::cout << (remark.must_be_mended ? "MEND  " : "note  ") << remark.sentence << "\n";
  }
  if (as_json)
    std::cout << list.dump() << "\n";
  else if (faults == 0)
    std::cout << file.string() << " has no fault; \"threadstation check\" tries its devices\n";
  if (faults > 0)
    throw std::runtime_error(file.string() + " has " + std::to_string(faults) + (faults == 1 ? " fault" : " faults") +
                             "; mend what is said above");
}

}  // namespace

void add_rig_command(CLI::App& app) {
  CLI::App* rig = app.add_subcommand("rig", "the file that says what a bench is made of");
  rig->require_subcommand(1);
  auto arguments = std::make_shared<NewArguments>();
  CLI::App* make_new = turns_platform(rig->add_subcommand(
      "new", "ask for a bench's measures, look at its platform, and write its rig file with every key explained"));
  make_new->add_option("--out", arguments->request.out, "new rig file")->required();
  make_new->add_option("--like", arguments->request.like,
                       "a rig file to begin with, instead of being asked for its kind");
  arguments->output.add_to(*make_new);
  make_new->callback([arguments] { make(*arguments); });

  auto file = std::make_shared<std::filesystem::path>();
  auto json = std::make_shared<bool>(false);
  CLI::App* check = rig->add_subcommand("check", "say what a rig file lacks, without touching a device");
  check->add_option("file", *file, "rig file")->required();
  check->add_flag("--json", *json, "as JSON, for machines");
  check->callback([file, json] { review(*file, *json); });
}

}  // namespace station
