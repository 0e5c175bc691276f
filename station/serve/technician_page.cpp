#include "station/serve/technician_page.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "station/capture/file_name.h"
#include "station/capture/folder_lock.h"
#include "station/capture/picture_record.h"
#include "station/capture/run_state.h"
#include "station/capture/session_folder.h"
#include "station/documents/rig_file.h"
#include "station/documents/session_file.h"
#include "station/library/library.h"
#include "station/serve/page_files.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kLongestClient = 64, kLongestText = 200;

// What a command said, or a client asked for, may be any bytes.
std::string written(const json& document) {
  return document.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

HttpResponse said(int status, const std::string& line) {
  return {.status = status, .content_type = "application/json", .body = written({{"message", line}})};
}

HttpResponse answered(const json& document) {
  return {.content_type = "application/json", .body = written(document)};
}

std::string text_of(const json& asked, const char* key) {
  const auto found = asked.find(key);
  return found != asked.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// Names of what is in a folder, sorted; of files without their ending.
std::vector<std::string> names_in(const fs::path& folder, bool folders) {
  std::vector<std::string> names;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = folders ? entry.path().filename().string() : entry.path().stem().string();
    if (problem_with_name(name)) continue;
    if (folders ? entry.is_directory(error) : entry.path().extension() == ".json" && entry.is_regular_file(error))
      names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

json library_lines(const fs::path& folder) {
  json lines = json::array();
  if (!fs::exists(folder / "index.sqlite")) return lines;
  for (const LibraryThread& thread : Library(folder, false).list()) {
    lines.push_back({{"number", thread.number},
                     {"name", thread.thread_name},
                     {"sample", thread.sample.name},
                     {"added_utc", thread.added_utc},
                     {"diameter_mm", thread.diameter_mm},
                     {"relative_rmse", nullptr}});
    if (thread.relative_rmse) lines.back()["relative_rmse"] = *thread.relative_rmse;
  }
  return lines;
}

}  // namespace

TechnicianPage::TechnicianPage(fs::path rig, fs::path workspace, std::function<void()> changed, fs::path program)
    : rig_(fs::absolute(rig)),
      workspace_(fs::absolute(workspace)),
      program_(std::move(program)),
      rig_name_(read_rig(rig).name),
      changed_(std::move(changed)) {
  for (const char* part : {"calibrations", "spools", "sessions", "jobs"}) {
    std::error_code error;
    fs::create_directories(workspace_ / part, error);
    if (error)
      throw std::runtime_error("cannot make " + (workspace_ / part).string() + ": " + error.message() +
                               "; choose another --workspace");
  }
}

// A lab has hundreds of sessions, and the page asks after every change: journals are read again only when they have grown.
json TechnicianPage::session_line(const fs::path& folder) {
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
      now.line["state"] = state_name(state_of(read_journal(journal).records, now.in_use));
      now.line["spool"] = session.sample ? session.sample->name : session.spool.name;
      now.line["utc"] = session.utc;
    } catch (const std::exception& problem) {
      now.line["problem"] = problem.what();
    }
    known = std::move(now);
  }
  json line = known.line;
  line["developed"] = fs::exists(folder / "linear", error);
  line["inverted"] = fs::exists(folder / "result" / "thread.json", error);
  line["report"] = fs::exists(folder / "report.html", error);
  return line;
}

std::shared_ptr<Job> TechnicianPage::job() const {
  const std::scoped_lock lock(mutex_);
  return job_;
}

bool TechnicianPage::in_control(const json& asked) const {
  const std::scoped_lock lock(mutex_);
  return !controller_.empty() && text_of(asked, "client") == controller_;
}

std::optional<HttpResponse> TechnicianPage::urgent(const HttpRequest& request) {
  if (request.method != "POST" || request.path != "/api/stop") return std::nullopt;
  const std::shared_ptr<Job> running = job();
  if (!running || !running->running()) return said(200, "nothing is running");
  running->stop_now();
  return said(200, "stopped");
}

HttpResponse TechnicianPage::handle(const HttpRequest& request) {
  const auto name = [&] { return request.query.contains("name") ? request.query.at("name") : std::string(); };
  if (request.method != "POST") {
    if (const PageFile* file = page_file(request.path))
      return {.content_type = file->content_type,
              .body = std::string(file->content),
              .headers = {{"Content-Security-Policy",
                           "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; form-action 'none'"}}};
    if (request.path == "/api/state") return state();
    if (request.path == "/api/events") return {.stream = true};
    if (request.path == "/api/session") return session(name());
    if (request.path == "/report") return report(name());
    return said(404, "there is no " + request.path.substr(0, kLongestText));
  }
  const json asked = json::parse(request.body, nullptr, false);
  if (!asked.is_object()) return said(400, "expected a JSON object");
  if (request.path == "/api/control") return take_control(asked);
  const bool known = request.path == "/api/job" || request.path == "/api/answer" || request.path == "/api/pause";
  if (!known) return said(404, "there is no " + request.path.substr(0, kLongestText));
  if (!in_control(asked)) return said(409, "another browser is in control; take control first");
  if (request.path == "/api/job") return start(asked);
  const std::shared_ptr<Job> running = job();
  if (!running || !running->running()) return said(409, "nothing is running");
  if (request.path == "/api/pause") {
    running->pause();
    return said(200, "pausing at the next safe point");
  }
  const auto done = asked.find("done");
  if (done == asked.end() || !done->is_boolean()) return said(400, "expected \"done\": true or false");
  running->answer(done->get<bool>());
  changed_();
  return said(200, done->get<bool>() ? "answered: done" : "answered: cannot be done now");
}

HttpResponse TechnicianPage::take_control(const json& asked) {
  const std::string client = text_of(asked, "client");
  if (client.empty() || client.size() > kLongestClient) return said(400, "expected \"client\": a name of its own");
  {
    const std::scoped_lock lock(mutex_);
    if (!controller_.empty() && controller_ != client && !asked.value("take", false))
      return said(409, "another browser is in control");
    controller_ = client;
  }
  changed_();
  return said(200, "in control");
}

HttpResponse TechnicianPage::state() {
  json document{{"rig", rig_name_}, {"job", nullptr}};
  if (const std::shared_ptr<Job> of = job()) document["job"] = of->state();
  {
    const std::scoped_lock lock(mutex_);
    document["control"] = controller_;
  }
  document["calibrations"] = names_in(workspace_ / "calibrations", true);
  document["spools"] = names_in(workspace_ / "spools", false);
  document["sessions"] = json::array();
  for (const std::string& name : names_in(workspace_ / "sessions", true))
    if (is_session(workspace_ / "sessions" / name))
      document["sessions"].push_back(session_line(workspace_ / "sessions" / name));
  document["library"] = library_lines(workspace_ / "library");
  return answered(document);
}

HttpResponse TechnicianPage::session(const std::string& name) {
  if (const auto problem = problem_with_name(name)) return said(400, *problem);
  const fs::path folder = workspace_ / "sessions" / name;
  if (!is_session(folder)) return said(404, "there is no session " + name);
  json document = session_line(folder);
  const Plan plan = read_session_file(folder).plan;
  const auto taken = taken_pictures(read_journal(folder / "journal.jsonl").records);
  document["views"] = json::array();
  for (const PlanStep& step : plan.steps) {
    if (step.kind != StepKind::view) continue;
    json view{{"number", document["views"].size() + 1}, {"step", step.id}, {"grade", nullptr}, {"reason", ""}};
    if (const auto picture = taken.find(step.id); picture != taken.end()) {
      view["grade"] = grade_name(picture->second.verdict.grade());
      view["reason"] = picture->second.verdict.reason();
    }
    document["views"].push_back(view);
  }
  return answered(document);
}

HttpResponse TechnicianPage::report(const std::string& name) const {
  if (const auto problem = problem_with_name(name)) return said(400, *problem);
  std::ifstream stream(workspace_ / "sessions" / name / "report.html", std::ios::binary);
  if (!stream) return said(404, "the session " + name + " has no report yet");
  return {.content_type = "text/html; charset=utf-8",
          .body = {std::istreambuf_iterator<char>(stream), {}},
          .headers = {{"Content-Security-Policy",
                       "default-src 'none'; img-src data:; style-src 'unsafe-inline'; frame-ancestors 'self'"}}};
}

// Every name is whitelisted before it becomes a part of a path, and no argument is anything but a name or a text of ours.
HttpResponse TechnicianPage::start(const json& asked) {
  const std::string kind = text_of(asked, "kind"), name = text_of(asked, "name");
  if (const auto problem = problem_with_name(name)) return said(400, *problem);
  const fs::path session = workspace_ / "sessions" / name;
  std::vector<std::string> arguments;
  if (kind == "calibrate") {
    arguments = {"calibrate", "--rig", rig_, "--out", workspace_ / "calibrations" / name};
  } else if (kind == "capture") {
    const std::string calibration = text_of(asked, "calibration"), spool = text_of(asked, "spool"),
                      person = text_of(asked, "person");
    for (const std::string& part : {calibration, spool})
      if (const auto problem = problem_with_name(part)) return said(400, *problem);
    if (person.size() > kLongestText) return said(400, "the operator's name is too long");
    arguments = {"capture",
                 "--rig",
                 rig_,
                 "--calibration",
                 workspace_ / "calibrations" / calibration,
                 "--spool",
                 workspace_ / "spools" / (spool + ".json"),
                 "--out",
                 session,
                 "--operator=" + person};
  } else if (kind == "resume") {
    arguments = {"capture", "--resume", "--out", session};
  } else if (kind == "reshoot") {
    const auto view = asked.find("view");
    if (view == asked.end() || !view->is_number_unsigned()) return said(400, "expected \"view\": its number");
    arguments = {"capture", "--out", session, "--reshoot", std::to_string(view->get<unsigned>())};
  } else if (kind == "develop" || kind == "invert" || kind == "report") {
    arguments = {kind, session};
  } else {
    return said(400, "expected \"kind\": calibrate, capture, resume, reshoot, develop, invert or report");
  }
  if (kind != "calibrate" && kind != "capture" && !is_session(session))
    return said(404, "there is no session " + name);
  {
    const std::scoped_lock lock(mutex_);
    if (job_ && job_->running()) return said(409, "a job is running; wait for it, or pause it");
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto number = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
    job_ = std::make_shared<Job>(JobRequest{.title = kind + " " + name,
                                            .arguments = arguments,
                                            .said = workspace_ / "jobs" / (std::to_string(number) + "-" + kind),
                                            .program = program_},
                                 changed_);
  }
  changed_();
  return said(200, "started");
}

}  // namespace station
