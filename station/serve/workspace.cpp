#include "station/serve/workspace.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include "station/documents/disk/file_name.h"
#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/reader.h"
#include "station/documents/session_file.h"
#include "station/serve/page_answers.h"
#include "station/session/record/picture_record.h"
#include "station/session/record/run_state.h"
#include "station/session/record/session_folder.h"
#include "station/session/results.h"
#include "station/session/spool_queue.h"
#include "station/thread/library.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<std::string> names_in(const fs::path& folder,
                                  const std::function<std::string(const fs::directory_entry&)>& name_of_entry) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (const std::string name = name_of_entry(entry); !problem_with_name(name)) names.push_back(name);
  std::ranges::sort(names);
  return names;
}

json thread_lines_of(const fs::path& folder) {
  json lines = json::array();
  if (!fs::exists(folder / "index.sqlite")) return lines;
  for (const LibraryThread& thread : Library(folder, false).list()) {
    lines.push_back({{"number", thread.number},
                     {"name", thread.thread_name},
                     {"sample", to_json(thread.sample)},
                     {"added_utc", thread.added_utc},
                     {"diameter_mm", thread.diameter_mm},
                     {"session", fs::path(thread.session).filename().string()},
                     {"sha256", thread.sha256},
                     {"tags", thread.tags},
                     {"relative_rmse", nullptr}});
    if (thread.relative_rmse) lines.back()["relative_rmse"] = *thread.relative_rmse;
  }
  return lines;
}

std::set<std::string> hashes_of(const json& thread_lines) {
  std::set<std::string> hashes;
  for (const json& line : thread_lines) hashes.insert(line.at("sha256").get<std::string>());
  return hashes;
}

// As Workspace::work_left() says, but for the library.
std::set<std::string> work_left_of(const fs::path& session, bool complete) {
  const fs::path views = session / "linear" / "views.json", thread = thread_file_of(session);
  std::set<std::string> left;
  if (!complete) left.insert("capture");
  if (!complete || !is_made(views, {session / "journal.jsonl"})) left.insert("develop");
  if (left.contains("develop") || !is_made(thread, {views})) left.insert("invert");
  if (left.contains("invert") || !is_made(session / "report.html", {thread, cloth_made_of_file(session)}))
    left.insert("report");
  return left;
}

json design_line(const fs::path& folder) {
  const std::string name = folder.filename().string();
  try {
    const json made_of = read_json_file(folder / kMadeOf);
    json pictures = json::array();
    for (const fs::path& picture : pictures_of_cloth(folder)) pictures.push_back(picture.stem().string());
    return {{"name", name},
            {"draft", made_of.value("draft", "")},
            {"threads", made_of.value("threads", json::array({"", ""}))},
            {"pictures", pictures},
            {"made", fs::last_write_time(folder / kMadeOf).time_since_epoch().count()}};
  } catch (const std::exception& problem) {
    return {{"name", name}, {"problem", problem_line(problem)}};
  }
}

// A spool as its form has it.
json spool_line(const fs::path& spool, const fs::path& sample) {
  json line{{"name", spool.stem().string()}, {"sample", nullptr}};
  try {
    const inversion::WrappedSpool wrapping = read_spool(spool).wrapping;
    line["turns"] = wrapping.turns;
    line["diameter_mm"] = wrapping.thread_diameter_mm;
    if (fs::exists(sample)) line["sample"] = to_json(read_sample_file(sample));
  } catch (const std::exception& problem) {
    line["problem"] = problem_line(problem);
  }
  return line;
}

}  // namespace

std::vector<std::string> folders_in(const fs::path& folder) {
  return names_in(folder, [](const fs::directory_entry& entry) {
    std::error_code error;
    return entry.is_directory(error) ? entry.path().filename().string() : std::string();
  });
}

std::vector<std::string> files_in(const fs::path& folder, const std::string& ending) {
  return names_in(folder, [&](const fs::directory_entry& entry) {
    std::error_code error;
    return entry.path().extension() == ending && entry.is_regular_file(error) ? entry.path().stem().string()
                                                                              : std::string();
  });
}

Workspace::Workspace(const fs::path& folder) : folder_(fs::absolute(folder)) {
  for (const char* part :
       {"calibrations", "spools", "samples", "sessions", "queues", "exports", "jobs", "rigs", "designs"}) {
    std::error_code error;
    fs::create_directories(folder_ / part, error);
    if (error)
      throw std::runtime_error("cannot make " + (folder_ / part).string() + ": " + error.message() +
                               "; choose another --workspace");
  }
}

// A lab has hundreds of sessions, and the page asks after every change: journals are read again only when they have
// grown.
json Workspace::session_line(const fs::path& folder, const std::set<std::string>& fits) {
  const std::string name = folder.filename().string();
  const fs::path journal = folder / "journal.jsonl";
  std::error_code error;
  ReadSession now{.journal_bytes = fs::file_size(journal, error),
                  .journal_time = fs::last_write_time(journal, error),
                  .in_use = folder_in_use(folder)};
  const std::scoped_lock lock(sessions_mutex_);
  ReadSession& known = sessions_[name];
  const bool same = !known.line.is_null() && known.journal_bytes == now.journal_bytes &&
                    known.journal_time == now.journal_time && known.in_use == now.in_use;
  if (!same) {
    now.line = {{"name", name}, {"state", "unreadable"}};
    try {
      const SessionFile session = read_session_file(folder);
      const auto records = read_journal(journal).records;
      now.line["state"] = state_name(state_of(records, now.in_use));
      const auto taken = taken_pictures(records);
      const auto is_view = [](const PlanStep& step) { return step.kind == StepKind::view; };
      now.line["views"] = std::ranges::count_if(session.plan.steps, is_view);
      now.line["taken"] = std::ranges::count_if(
          session.plan.steps, [&](const PlanStep& step) { return is_view(step) && taken.contains(step.id); });
      now.line["spool"] = session.sample && !session.sample->name.empty() ? session.sample->name : session.spool.name;
      now.line["utc"] = session.utc;
    } catch (const std::exception& problem) {
      now.line["problem"] = problem_line(problem);
    }
    known = std::move(now);
  }
  json line = known.line;
  line["inverted"] = fs::exists(folder / "result" / "thread.json", error);
  line["cloth"] = fs::exists(folder / "result" / "cloth" / "swatch.png", error);
  line["report"] = fs::exists(folder / "report.html", error);
  line["left"] = json::array();
  if (known.line.contains("problem")) return line;
  const std::set<std::string> left = left_of(folder, line["state"] == state_name(RunState::complete), fits);
  for (const char* step : {"capture", "develop", "invert", "report", "add"})
    if (left.contains(step)) line["left"].push_back(step);
  return line;
}

json Workspace::thread_lines() const {
  return thread_lines_of(threads_folder());
}

json Workspace::queue_line(const std::string& name) {
  json line{{"name", name}, {"spools", json::array()}};
  try {
    for (const QueuedSpool& row : read_queue(queue(name))) {
      json spool{{"session", row.session}, {"sample", to_json(row.sample)}, {"state", nullptr}};
      if (is_session(session(row.session))) spool["state"] = session_line(session(row.session), {})["state"];
      line["spools"].push_back(spool);
    }
  } catch (const std::exception& problem) {
    line["problem"] = problem_line(problem);
  }
  return line;
}

json Workspace::contents() {
  json document{{"calibrations", json::array()}, {"spools", json::array()},
                {"sessions", json::array()},     {"queues", json::array()},
                {"threads", thread_lines()},     {"exports", folders_in(folder_ / "exports")}};
  for (const std::string& name : folders_in(folder_ / "calibrations"))
    document["calibrations"].push_back(calibrations_.line(calibration(name)));
  for (const std::string& name : files_in(folder_ / "spools", ".json"))
    document["spools"].push_back(spool_line(spool(name), sample(name)));
  const std::set<std::string> fits = hashes_of(document["threads"]);
  for (const std::string& name : folders_in(folder_ / "sessions"))
    if (is_session(session(name))) document["sessions"].push_back(session_line(session(name), fits));
  document["designs"] = json::array();
  for (const std::string& name : folders_in(folder_ / "designs"))
    if (fs::exists(design(name) / kMadeOf)) document["designs"].push_back(design_line(design(name)));
  for (const std::string& name : files_in(folder_ / "queues", ".csv")) document["queues"].push_back(queue_line(name));
  return document;
}

fs::path Workspace::thread_in_library(int number) const {
  try {
    const Library threads(threads_folder(), false);
    return threads.thread_file(threads.show(number).number);
  } catch (const std::runtime_error& problem) {
    throw Refused(404, problem.what());
  }
}

fs::path Workspace::existing_session(const std::string& name) const {
  const fs::path found = session(checked_name(name));
  if (!is_session(found)) throw Refused(404, "there is no session " + name);
  return found;
}

fs::path Workspace::existing_calibration(const std::string& name) const {
  const fs::path found = calibration(checked_name(name));
  if (!fs::exists(found / "calibration.json")) throw Refused(404, "there is no calibration " + name + " yet");
  return found;
}

std::set<std::string> Workspace::work_left(const std::string& name) const {
  const fs::path folder = existing_session(name);
  const RunState state = state_of(read_journal(folder / "journal.jsonl").records, folder_in_use(folder));
  return left_of(folder, state == RunState::complete, hashes_of(thread_lines()));
}

std::set<std::string> Workspace::left_of(const fs::path& session, bool complete,
                                         const std::set<std::string>& fits) const {
  std::set<std::string> left = work_left_of(session, complete);
  if (left.contains("invert") || !fits.contains(fit_hash(session))) left.insert("add");
  return left;
}

std::string Workspace::fit_hash(const fs::path& session) const {
  std::error_code error;
  const fs::path file = thread_file_of(session);
  const auto time = fs::last_write_time(file, error);
  if (error) return "";
  const std::scoped_lock lock(fits_mutex_);
  ReadFit& known = fits_[session.filename().string()];
  if (known.sha256.empty() || known.time != time) known = {.time = time, .sha256 = sha256_hex(text_of_file(file))};
  return known.sha256;
}

json Workspace::session_document(const std::string& name) {
  const fs::path folder = existing_session(name);
  json document = session_line(folder, hashes_of(thread_lines()));
  const Plan plan = read_session_file(folder).plan;
  const auto taken = taken_pictures(read_journal(folder / "journal.jsonl").records);
  document["views"] = json::array();
  for (const PlanStep& step : plan.steps) {
    if (step.kind != StepKind::view) continue;
    json view{{"number", document["views"].size() + 1}, {"step", step.id}, {"grade", nullptr}, {"reason", ""}};
    if (const auto picture = taken.find(step.id); picture != taken.end()) {
      view["grade"] = grade_name(picture->second.verdict.grade());
      view["reason"] = picture->second.verdict.reason();
      view["picture"] = picture->second.sha256;
    }
    document["views"].push_back(view);
  }
  return document;
}

}  // namespace station
