#include <cstdio>
#include <iostream>
#include <optional>

#include "calibration/light/colour_chart.h"
#include "renderer/picture/image_file.h"
#include "rig/devices/clock.h"
#include "station/commands/commands.h"
#include "station/commands/ready_name.h"
#include "station/documents/srgb.h"
#include "station/thread/library.h"

namespace station {
namespace {

struct LibraryArguments {
  std::string folder = "library", what, out;
  std::optional<std::string> barcode, name, lot, material, colour, note, tags;
  int number = 0;
  bool json = false;
  LibraryQuery query;
  std::string near;
  std::vector<double> diameter_mm, highlight_rad;
};

nlohmann::json to_json(const LibraryThread& thread) {
  nlohmann::json document = {
      {"number", thread.number},           {"sample", to_json(thread.sample)},  {"thread", thread.thread_name},
      {"added_utc", thread.added_utc},     {"sha256", thread.sha256},           {"session", thread.session},
      {"session_utc", thread.session_utc}, {"diameter_mm", thread.diameter_mm}, {"tags", thread.tags}};
  if (thread.relative_rmse) document["relative_rmse"] = *thread.relative_rmse;
  if (thread.lab) document["lab"] = {(*thread.lab)[0], (*thread.lab)[1], (*thread.lab)[2]};
  if (thread.highlight_rad) document["highlight_rad"] = *thread.highlight_rad;
  if (thread.distance) document["distance"] = *thread.distance;
  return document;
}

void print_line(const LibraryThread& thread) {
  std::printf("%4d  %-24s %-12s %-10s %-12s %s", thread.number, thread.thread_name.c_str(),
              thread.sample.barcode.c_str(), thread.sample.lot.c_str(), thread.sample.material.c_str(),
              thread.sample.colour.c_str());
  if (thread.relative_rmse) std::printf("  %.1f %%", 100 * *thread.relative_rmse);
  if (thread.distance) std::printf("  %.1f from the colour", *thread.distance);
  std::printf("\n");
}

std::string joined(const std::vector<std::string>& tags) {
  std::string text;
  for (const std::string& tag : tags) text += (text.empty() ? "" : ", ") + tag;
  return text;
}

void print_all(const LibraryThread& thread) {
  std::printf(
      "number      %d\nthread      %s\nbarcode     %s\nspool       %s\nlot         %s\nmaterial    %s\n"
      "colour      %s\nnote        %s\ndiameter    %.4g mm\nsession     %s\ncaptured    %s\nadded       %s\n"
      "sha256      %s\ntags        %s\n",
      thread.number, thread.thread_name.c_str(), thread.sample.barcode.c_str(), thread.sample.name.c_str(),
      thread.sample.lot.c_str(), thread.sample.material.c_str(), thread.sample.colour.c_str(),
      thread.sample.note.c_str(), thread.diameter_mm, thread.session.c_str(), thread.session_utc.c_str(),
      thread.added_utc.c_str(), thread.sha256.c_str(), joined(thread.tags).c_str());
  if (thread.relative_rmse) std::printf("agreement   %.1f %% relative RMSE\n", 100 * *thread.relative_rmse);
}

void print(const LibraryThread& thread, bool json) {
  if (json)
    std::cout << to_json(thread).dump() << "\n";
  else
    print_line(thread);
}

Eigen::Vector3d lab_of(const Srgb8& colour) {
  const cv::Vec3f linear = renderer::linear_of_srgb({colour[0], colour[1], colour[2]});
  return calibration::lab_of_linear_srgb({linear[0], linear[1], linear[2]});
}

std::optional<std::array<double, 2>> range_of(const std::vector<double>& ends) {
  if (ends.empty()) return std::nullopt;
  return std::array{ends[0], ends[1]};
}

void list(const LibraryArguments& arguments) {
  LibraryQuery query = arguments.query;
  if (!arguments.near.empty()) query.near_lab = lab_of(parse_colour(arguments.near));
  query.diameter_mm = range_of(arguments.diameter_mm);
  query.highlight_rad = range_of(arguments.highlight_rad);
  const auto threads = Library(arguments.folder, false).find(query);
  if (arguments.json) {
    nlohmann::json all = nlohmann::json::array();
    for (const LibraryThread& thread : threads) all.push_back(to_json(thread));
    std::cout << all.dump() << "\n";
    return;
  }
  for (const LibraryThread& thread : threads) print_line(thread);
  std::printf("%zu thread(s)\n", threads.size());
}

void edit(const LibraryArguments& arguments) {
  Library library(arguments.folder, false);
  Sample sample = library.show(arguments.number).sample;
  sample.barcode = arguments.barcode.value_or(sample.barcode);
  sample.name = arguments.name.value_or(sample.name);
  sample.lot = arguments.lot.value_or(sample.lot);
  sample.material = arguments.material.value_or(sample.material);
  sample.colour = arguments.colour.value_or(sample.colour);
  sample.note = arguments.note.value_or(sample.note);
  const std::vector<std::string> tags = tags_of(arguments.tags.value_or(""));  // refused before anything is written
  LibraryThread edited = library.edit(arguments.number, sample);
  if (arguments.tags) edited = library.tag(arguments.number, tags);
  print(edited, arguments.json);
}

}  // namespace

void add_library_command(CLI::App& app) {
  auto arguments = std::make_shared<LibraryArguments>();
  CLI::App* command = app.add_subcommand("library", "the lab's collection of digitized threads");
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* description) {
    CLI::App* sub = command->add_subcommand(name, description);
    sub->add_option("--library", arguments->folder, "the library's folder")->capture_default_str();
    return sub;
  };
  CLI::App* added = add("add", "take in a session's thread, or a thread file");
  or_ready("threads",
           added->add_option("what", arguments->what, "session folder, thread file or a ready thread's name"))
      ->required();
  added->add_flag("--json", arguments->json, "as JSON, for machines");
  added->callback([arguments] {
    rig::SystemClock clock;
    print(Library(arguments->folder, true).add(arguments->what, clock.utc()), arguments->json);
  });
  CLI::App* listed = add("list", "one line for each thread");
  LibraryQuery& query = arguments->query;
  listed->add_option("words", query.words, "only threads with these words in name, barcode, lot, material, tags, ...");
  listed->add_option("--near", arguments->near,
                     "like #c01830, crimson or \"lab(40 60 30)\": the nearest to this colour first");
  listed->add_option("--within", query.within, "how far from it they may be, in Lab (CIE 1976)")
      ->check(CLI::Range(0.0, 500.0))
      ->capture_default_str();
  listed->add_option("--diameter", arguments->diameter_mm, "least and most, mm")->expected(2);
  listed
      ->add_option("--highlight", arguments->highlight_rad,
                   "least and most width of the highlight along the thread, rad: glossy ones have little")
      ->expected(2);
  listed->add_option("--most", query.most, "so many threads at most")->check(CLI::Range(1, 1 << 30));
  listed->add_flag("--json", arguments->json, "as JSON, for machines");
  listed->callback([arguments] { list(*arguments); });
  CLI::App* shown = add("show", "all that is known of one thread");
  shown->add_option("number", arguments->number, "of the thread in the list")->required();
  shown->add_flag("--json", arguments->json, "as JSON, for machines");
  shown->callback([arguments] {
    const LibraryThread thread = Library(arguments->folder, false).show(arguments->number);
    if (arguments->json)
      std::cout << to_json(thread).dump() << "\n";
    else
      print_all(thread);
  });
  CLI::App* edited = add("edit", "write anew what the lab knows of a thread's spool");
  edited->add_option("number", arguments->number, "of the thread in the list")->required();
  edited->add_option("--barcode", arguments->barcode, "of the spool");
  edited->add_option("--name", arguments->name, "of the spool");
  edited->add_option("--lot", arguments->lot, "of the spool");
  edited->add_option("--material", arguments->material, "its fiber");
  edited->add_option("--colour", arguments->colour, "in words");
  edited->add_option("--note", arguments->note, "any text");
  edited->add_option("--tags", arguments->tags, "words of the lab's own, parted by commas, in place of earlier ones");
  edited->add_flag("--json", arguments->json, "as JSON, for machines");
  edited->callback([arguments] { edit(*arguments); });
  CLI::App* removed = add("remove", "take a thread out of the list; its file and number stay");
  removed->add_option("number", arguments->number, "of the thread in the list")->required();
  removed->callback([arguments] {
    rig::SystemClock clock;
    Library(arguments->folder, false).remove(arguments->number, clock.utc());
    std::cout << "taken out: " << arguments->number << "; threadstation library restore puts it back\n";
  });
  CLI::App* restored = add("restore", "put back a thread that was taken out");
  restored->add_option("number", arguments->number, "that the thread had")->required();
  restored->callback([arguments] {
    Library library(arguments->folder, false);
    library.restore(arguments->number);
    print_line(library.show(arguments->number));
  });
  CLI::App* exported = add("export", "one thread with its sample and hashes, in a folder of its own");
  exported->add_option("number", arguments->number, "of the thread in the list")->required();
  exported->add_option("--out", arguments->out, "new folder")->required();
  exported->add_flag("--json", arguments->json, "as JSON, for machines");
  exported->callback([arguments] {
    Library(arguments->folder, false).export_thread(arguments->number, arguments->out);
    if (arguments->json)
      std::cout << nlohmann::json{{"exported", arguments->out}}.dump() << "\n";
    else
      std::cout << "exported: " << arguments->out << "\n";
  });
}

}  // namespace station
