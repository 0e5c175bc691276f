#include "station/serve/job_command.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "station/cloth/preview/cloth_stage.h"
#include "station/data/data_folder.h"
#include "station/documents/cloth_fibers.h"
#include "station/documents/disk/file_name.h"
#include "station/serve/page_answers.h"
#include "station/session/results.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Words = std::vector<std::string>;

constexpr std::uint64_t kLargestNumber = 1'000'000;
constexpr const char* kReadyThreads = "library/threads";

struct Asked {
  const json& fields;
  const Workspace& workspace;
  const fs::path& rig;

  std::string name() const { return name_of(fields, "name"); }
  // Of what is made now, as a person writes it: with spaces, umlauts and the like.
  std::string new_name() const { return checked_name(safe_name(text("name"))); }
  fs::path session() const { return workspace.existing_session(name()); }
  fs::path calibration() const { return workspace.calibration(name_of(fields, "calibration")); }
  std::string text(const char* key) const {
    const std::string text = text_of(fields, key);
    if (text.size() > kLongestText) throw Refused(400, std::string("the text of \"") + key + "\" is too long");
    return text;
  }
  int number(const char* key) const {
    const auto found = fields.find(key);
    if (found == fields.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > kLargestNumber)
      throw Refused(400, std::string("expected \"") + key + "\": a number");
    return found->get<int>();
  }
  std::string thread() const { return workspace.thread_in_library(number("number")); }
  // Of the library by its number, or a ready one by its name.
  std::string thread_or_ready(const char* key) const {
    const auto found = fields.find(key);
    if (found != fields.end() && found->is_string()) return ready_thread(name_of(fields, key));
    return workspace.thread_in_library(number(key));
  }
  bool flag(const char* key) const {
    const auto found = fields.find(key);
    return found != fields.end() && found->is_boolean() && found->get<bool>();
  }
};

Words check(const Asked& asked) {
  Words words{"check", "--rig", asked.rig};
  if (!text_of(asked.fields, "calibration").empty())
    words.insert(words.end(), {"--calibration", asked.calibration().string()});
  return words;
}

// An option without a text would take the next word for it.
void add_person(Words& words, const Asked& asked) {
  if (const std::string person = asked.text("person"); !person.empty()) words.push_back("--operator=" + person);
}

Words capture(const Asked& asked) {
  const std::string spool = name_of(asked.fields, "spool");
  Words words{"capture",
              "--rig",
              asked.rig,
              "--calibration",
              asked.calibration(),
              "--spool",
              asked.workspace.spool(spool),
              "--out",
              asked.workspace.session(asked.new_name())};
  add_person(words, asked);
  if (fs::exists(asked.workspace.sample(spool)))
    words.insert(words.end(), {"--sample", asked.workspace.sample(spool).string()});
  return words;
}

Words queue(const Asked& asked) {
  Words words{"capture",           "--queue", asked.workspace.queue(asked.name()),  "--rig", asked.rig, "--calibration",
              asked.calibration(), "--out",   asked.workspace.folder() / "sessions"};
  add_person(words, asked);
  return words;
}

Words develop(const fs::path& session) {
  return {"develop", session};
}

Words invert(const Asked& asked, const fs::path& session) {
  Words words{"invert", session};
  if (asked.flag("quick")) words.insert(words.end(), {"--paths", "128", "--paths", "256", "--spp", "4"});
  return words;
}

Words report(const fs::path& session) {
  return {"report", session};
}

Words add(const Asked& asked, const fs::path& session) {
  return {"library", "add", session, "--library", asked.workspace.threads_folder()};
}

Words resume(const Asked& asked) {
  return {"capture", "--resume", "--out", asked.session()};
}

// What follows a capture, as far as it is left to do.
void add_processing(std::vector<JobStep>& steps, const Asked& asked, const fs::path& session,
                    const std::set<std::string>& left) {
  const std::vector<JobStep> all{{"develop", develop(session)},
                                 {"invert", invert(asked, session)},
                                 {"report", report(session)},
                                 {"add", add(asked, session)}};
  std::ranges::copy_if(all, std::back_inserter(steps), [&](const JobStep& step) { return left.contains(step.kind); });
}

std::vector<JobStep> digitize(const Asked& asked) {
  std::vector<JobStep> steps{{"capture", capture(asked)}};
  add_processing(steps, asked, asked.workspace.session(asked.new_name()), {"develop", "invert", "report", "add"});
  return steps;
}

std::vector<JobStep> process(const Asked& asked) {
  const std::set<std::string> left = asked.workspace.work_left(asked.name());
  std::vector<JobStep> steps;
  if (left.contains("capture")) steps.push_back({"resume", resume(asked)});
  add_processing(steps, asked, asked.session(), left);
  if (steps.empty()) throw Refused(409, "the session " + asked.name() + " lacks nothing: it is in the library");
  return steps;
}

void add_cloth_options(Words& words, const Asked& asked) {
  words.insert(words.end(), {"--draft", ready_draft(name_of(asked.fields, "draft")).string()});
  for (const auto& [key, option] : {std::pair("warp_colour", "--warp-colour="), {"weft_colour", "--weft-colour="}})
    if (const std::string colour = asked.text(key); !colour.empty()) words.push_back(option + colour);
  if (asked.flag("quick")) words.emplace_back("--quick");
}

Words cloth(const Asked& asked) {
  Words words{"cloth", asked.session()};
  add_cloth_options(words, asked);
  return words;
}

// How it is seen, and how large.
void add_view(Words& words, const Asked& asked) {
  const ClothView view = cloth_view_of(asked.fields);
  if (const auto problem = problem_of(view)) throw Refused(400, *problem);
  for (const auto& [option, value] : {std::pair("--turn=", view.turn_deg),
                                      {"--tilt=", view.tilt_deg},
                                      {"--light-turn=", view.light_turn_deg},
                                      {"--light-tilt=", view.light_tilt_deg},
                                      {"--zoom=", view.zoom}})
    words.push_back(option + std::to_string(value));
  if (asked.fields.contains("size_px")) words.insert(words.end(), {"--size", std::to_string(asked.number("size_px"))});
}

// Cloth of one thread of the library or of two.
Words design(const Asked& asked) {
  const fs::path folder = asked.workspace.design(asked.new_name());
  if (fs::exists(folder / kMadeOf))
    throw Refused(409, "there is a design " + folder.filename().string() + " already; give this one another name");
  Words words = design_words(asked.fields, asked.workspace);
  words.insert(words.begin(), "cloth");
  words.insert(words.end(), {"--out", folder});
  add_view(words, asked);
  if (asked.flag("quick")) words.emplace_back("--quick");
  return words;
}

// For programs that render cloth by textures, coarse enough to wait for.
Words design_export(const Asked& asked) {
  const fs::path folder = asked.workspace.design(name_of(asked.fields, "design"));
  if (!fs::exists(folder / kMadeOf)) throw Refused(404, "there is no design " + folder.filename().string());
  return {"export",  "cloth",
          "--draft", folder / "draft.json",
          "--warp",  folder / "warp_thread.json",
          "--weft",  folder / "weft_thread.json",
          "--only",  "gltf,textures",
          "--size",  "256",
          "--spp",   "16",
          "--out",   asked.workspace.exported(asked.name())};
}

using Commands = std::map<std::string, std::function<Words(const Asked&)>>;

Words folder_export(const Asked& asked) {
  return {"library",
          "export",
          std::to_string(asked.number("number")),
          "--library",
          asked.workspace.threads_folder(),
          "--out",
          asked.workspace.exported(asked.name())};
}

Words materials_export(const Asked& asked) {
  return {"export",
          "thread",
          asked.thread(),
          "--only",
          "mitsuba,blender,csv,numpy",
          "--out",
          asked.workspace.exported(asked.name())};
}

// A twill of the thread alone, coarse enough to wait for.
Words textures_export(const Asked& asked) {
  const std::string thread = asked.thread();
  return {"export",  "cloth",
          "--draft", ready_draft("twill_2_2"),
          "--warp",  thread,
          "--weft",  thread,
          "--size",  "128",
          "--spp",   "16",
          "--out",   asked.workspace.exported(asked.name())};
}

// Exports of a thread in the library, each into a new folder of exports/.
const Commands kExports{{"folder", folder_export}, {"materials", materials_export}, {"textures", textures_export}};

Words exported(const Asked& asked) {
  const auto format = kExports.find(asked.text("format"));
  if (format == kExports.end()) throw Refused(400, "expected \"format\": one that the station's state offers");
  return format->second(asked);
}

const Commands kKinds{
    {"check", check},
    {"preview",
     [](const Asked& asked) {
       return Words{"preview", "--rig", asked.rig, "--out", asked.workspace.preview()};
     }},
    {"calibrate",
     [](const Asked& asked) {
       return Words{"calibrate",
                    "--rig",
                    asked.rig,
                    "--out",
                    asked.workspace.calibration(asked.new_name()),
                    "--live",
                    asked.workspace.preview()};
     }},
    {"home",
     [](const Asked& asked) {
       Words words{"home", "--rig", asked.rig};
       if (asked.flag("mark")) words.emplace_back("--mark");
       return words;
     }},
    {"rig",
     [](const Asked& asked) {
       return Words{"rig", "new", "--like", asked.rig, "--out", asked.workspace.rig(asked.new_name())};
     }},
    {"capture", capture},
    {"queue", queue},
    {"resume", resume},
    {"reshoot",
     [](const Asked& asked) {
       return Words{"capture", "--out", asked.session(), "--reshoot", std::to_string(asked.number("view"))};
     }},
    {"develop", [](const Asked& asked) { return develop(asked.session()); }},
    {"invert", [](const Asked& asked) { return invert(asked, asked.session()); }},
    {"report", [](const Asked& asked) { return report(asked.session()); }},
    {"cloth", cloth},
    {"design", design},
    {"design_export", design_export},
    {"add", [](const Asked& asked) { return add(asked, asked.session()); }},
    {"export", exported},
};

// Those that are several of the others, one after the other.
const std::map<std::string, std::function<std::vector<JobStep>(const Asked&)>> kSequences{{"digitize", digitize},
                                                                                          {"process", process}};

std::string all_kinds() {
  std::string names;
  for (const auto& [name, words] : kKinds) names += (names.empty() ? "" : ", ") + name;
  for (const auto& [name, steps] : kSequences) names += ", " + name;
  return names;
}

std::vector<JobStep> steps_of(const std::string& kind, const Asked& asked) {
  if (const auto found = kSequences.find(kind); found != kSequences.end()) return found->second(asked);
  const auto found = kKinds.find(kind);
  if (found == kKinds.end()) throw Refused(400, "expected \"kind\": one of " + all_kinds());
  return {{kind, found->second(asked)}};
}

}  // namespace

JobCommand job_command(const json& asked, const Workspace& workspace, const fs::path& rig) {
  const std::string kind = text_of(asked, "kind");
  std::vector<JobStep> steps = steps_of(kind, {asked, workspace, rig});
  const std::string name = text_of(asked, "name");
  return {.title = kind + (name.empty() ? "" : " " + name), .steps = std::move(steps)};
}

std::vector<std::string> design_words(const json& fields, const Workspace& workspace) {
  const fs::path no_rig;
  const Asked asked{fields, workspace, no_rig};
  const std::string warp = asked.thread_or_ready("number"), weft = asked.thread_or_ready("weft");
  Words words{warp};
  if (weft != warp) words.insert(words.end(), {"--weft", weft});
  words.insert(words.end(), {"--draft", ready_draft(name_of(fields, "draft")).string()});
  if (const std::string shape = asked.text("shape"); !shape.empty()) {
    const std::vector<std::string> shapes = cloth_shapes();
    if (std::ranges::find(shapes, shape) == shapes.end()) throw Refused(404, "there is no shape " + shape);
    words.insert(words.end(), {"--shape", shape});
  }
  if (const std::string fibers = asked.text("fibers"); !fibers.empty()) {
    const std::vector<std::string> kinds = fiber_kinds();
    if (std::ranges::find(kinds, fibers) == kinds.end()) throw Refused(404, "there are no fibers " + fibers);
    words.insert(words.end(), {"--fibers", fibers});
  }
  return words;
}

std::vector<std::string> export_formats() {
  std::vector<std::string> names;
  for (const auto& [name, command] : kExports) names.push_back(name);
  return names;
}

fs::path ready_draft(const std::string& name) {
  const fs::path file = data_folder() / "drafts" / (checked_name(name) + ".json");
  if (!fs::exists(file)) throw Refused(404, "there is no draft " + name);
  return file;
}

std::vector<std::string> ready_drafts() {
  return files_in(data_folder() / "drafts", ".json");
}

fs::path ready_thread(const std::string& name) {
  const fs::path file = data_folder() / kReadyThreads / (checked_name(name) + ".json");
  if (!fs::exists(file)) throw Refused(404, "there is no ready thread " + name);
  return file;
}

std::vector<std::string> ready_threads() {
  return files_in(data_folder() / kReadyThreads, ".json");
}

}  // namespace station
