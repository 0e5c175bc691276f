#include "station/serve/technician_page.h"

#include <charconv>
#include <chrono>
#include <limits>
#include <thread>

#include "rig/devices/clock.h"
#include "station/cloth/preview/cloth_stage.h"
#include "station/data/data_folder.h"
#include "station/documents/cloth_fibers.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/reader.h"
#include "station/serve/batches.h"
#include "station/serve/checked_devices.h"
#include "station/serve/handbook_page.h"
#include "station/serve/job_command.h"
#include "station/serve/label.h"
#include "station/serve/left_jobs.h"
#include "station/serve/page_answers.h"
#include "station/serve/page_files.h"
#include "station/serve/page_pictures.h"
#include "station/serve/result_document.h"
#include "station/serve/spool_form.h"
#include "station/serve/zip_download.h"
#include "station/thread/library.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kLongestClient = 64;
constexpr const char* kLiveView = "preview";

std::string word_of(const HttpRequest& request, const char* key) {
  const auto found = request.query.find(key);
  return found == request.query.end() ? std::string() : found->second;
}

[[noreturn]] void refuse_path(const HttpRequest& request) {
  throw Refused(404, "there is no " + request.path.substr(0, kLongestText));
}

json result_of(const Workspace& workspace, const std::string& name) {
  const fs::path session = workspace.existing_session(name);
  if (!fs::exists(session / "result" / "thread.json")) throw Refused(404, "the session has no fitted thread yet");
  return result_document(session);
}

int number_of(const std::string& text) {
  int number = 0;
  const char* end = text.data() + text.size();
  if (std::from_chars(text.data(), end, number) != std::from_chars_result{end, std::errc()})
    throw Refused(400, "expected the number of a thread");
  return number;
}

// Reads out of the library. Throws Refused (404) with the line of the code that reads it.
template <class Read>
auto from_library(const Workspace& workspace, const Read& read) {
  if (!fs::exists(workspace.threads_folder() / "index.sqlite")) throw Refused(404, "the library is empty");
  try {
    return read(Library(workspace.threads_folder(), false));
  } catch (const std::runtime_error& problem) {
    throw Refused(404, problem.what());
  }
}

// With another thread's number, also "delta_e_2000": how far their colours are apart.
json thread_of(const Workspace& workspace, const std::string& number, const std::string& other = {}) {
  json document = from_library(workspace, [at = number_of(number)](const Library& library) {
    return thread_document(read_thread(library.thread_file(at)));
  });
  if (!other.empty()) document["delta_e_2000"] = colour_difference(document, thread_of(workspace, other));
  return document;
}

// A page that this program wrote: no scripts, nothing from elsewhere.
HttpResponse own_page(const std::string& page) {
  return {.content_type = "text/html; charset=utf-8",
          .body = page,
          .headers = {{"Content-Security-Policy",
                       "default-src 'none'; img-src data:; style-src 'unsafe-inline'; frame-ancestors 'self'"}}};
}

}  // namespace

TechnicianPage::TechnicianPage(const fs::path& rig, const fs::path& workspace, std::function<void()> changed,
                               fs::path program)
    : rig_file_(fs::absolute(rig)),
      program_(std::move(program)),
      rig_(read_rig(rig)),
      workspace_(workspace),
      frame_(workspace_, rig_),
      look_(workspace_, program_),
      pictures_(workspace_, changed, program_),
      changed_(std::move(changed)) {
  data_folder();  // without it no screen would come up
}

std::shared_ptr<Job> TechnicianPage::job() const {
  const std::scoped_lock lock(mutex_);
  return job_;
}

std::shared_ptr<Job> TechnicianPage::running_job() const {
  const std::shared_ptr<Job> running = job();
  if (!running || !running->running()) throw Refused(409, "nothing is running");
  return running;
}

bool TechnicianPage::in_control(const json& asked) const {
  const std::scoped_lock lock(mutex_);
  return !controller_.empty() && text_of(asked, "client") == controller_;
}

std::optional<HttpResponse> TechnicianPage::urgent(const HttpRequest& request) {
  if (request.method != "POST" || request.path != "/api/stop") return std::nullopt;
  std::shared_ptr<Job> running;
  fs::path own;
  {
    const std::scoped_lock lock(mutex_);
    ++stops_;
    running = job_;
    own = job_said_;
  }
  const bool runs = running && running->running();
  if (runs) running->stop_now();
  if (!stop_left_jobs(workspace_.folder() / "jobs", own += kProcessFile) && !runs)
    return said(200, "nothing is running");
  return said(200, "stopped");
}

HttpResponse TechnicianPage::handle(const HttpRequest& request) {
  try {
    return request.method == "POST" ? post(request) : get(request);
  } catch (const Refused& refused) {
    return said(refused.status(), refused.what());
  }
}

HttpResponse TechnicianPage::get(const HttpRequest& request) {
  if (const PageFile* file = page_file(request.path))
    return {.content_type = file->content_type,
            .body = std::string(file->content),
            .headers = {{"Content-Security-Policy",
                         "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; form-action 'none'"}}};
  if (request.path.starts_with(kHandbook)) return handbook_page(request.path.substr(std::string(kHandbook).size()));
  if (request.path == "/api/state") return answered(state());
  if (request.path == "/api/events") return {.stream = true};
  if (request.path == "/api/bench") return answered(bench());
  if (request.path == "/api/calibration")
    return answered(calibration_in_full(workspace_.existing_calibration(word_of(request, "name"))));
  if (request.path == "/api/session") return answered(workspace_.session_document(word_of(request, "name")));
  if (request.path == "/api/result") return answered(result_of(workspace_, word_of(request, "name")));
  if (request.path == "/api/thread")
    return answered(thread_of(workspace_, word_of(request, "number"), word_of(request, "with")));
  if (request.path == "/api/batches") return answered(batches_document(workspace_));
  if (request.path == "/batch") return own_page(batch_report_page(workspace_, word_of(request, "name")));
  if (request.path == "/api/lots") return answered(from_library(workspace_, lots_document));
  if (request.path == "/label")
    return {.content_type = "image/svg+xml",
            .body = from_library(workspace_, [at = number_of(word_of(request, "number"))](const Library& library) {
              return label_svg(library.show(at));
            })};
  if (request.path == "/api/look") return answered(look_.state());
  if (request.path == "/picture" && word_of(request, "of") == "look") return look_.picture();
  if (request.path == "/picture") return page_picture(request, workspace_, frame_);
  if (request.path == "/download") {
    const std::string& name = checked_name(word_of(request, "name"));
    return zip_of(word_of(request, "of") == "design" ? workspace_.design(name) : workspace_.exported(name));
  }
  if (request.path == "/report") return report(word_of(request, "name"));
  if (request.path == "/calibration") return calibration_report(word_of(request, "name"));
  refuse_path(request);
}

HttpResponse TechnicianPage::post(const HttpRequest& request) {
  const json asked = json::parse(request.body, nullptr, false);
  if (!asked.is_object()) throw Refused(400, "expected a JSON object");
  if (request.path == "/api/control") return take_control(asked);
  const auto& path = request.path;
  if (path != "/api/job" && path != "/api/answer" && path != "/api/pause" && path != "/api/spool" &&
      path != "/api/thread" && path != "/api/import" && path != "/api/look" && path != "/api/batch")
    refuse_path(request);
  if (!in_control(asked)) throw Refused(409, "another browser is in control; take control first");
  if (path == "/api/job") return start(asked);
  if (path == "/api/answer") return answer(asked);
  if (path == "/api/thread") return change_thread(asked);
  if (path == "/api/import") return import_thread(asked);
  if (path == "/api/look") return look(asked);
  if (path == "/api/batch") return said(200, stop_batch(workspace_, text_of(asked, "name")));
  if (path == "/api/spool") {
    const std::string name = write_spool(asked, workspace_, rig_file_);
    changed_();
    HttpResponse response = answered({{"message", "written: spool " + name}, {"name", name}});
    return response;
  }
  running_job()->pause();
  return said(200, "pausing at the next safe point");
}

HttpResponse TechnicianPage::change_thread(const json& asked) {
  const auto number = asked.find("number");
  if (number == asked.end() || !number->is_number_unsigned() || *number > std::numeric_limits<int>::max())
    throw Refused(400, "expected \"number\": of a thread");
  const auto removed = asked.find("removed");
  try {
    Library library(workspace_.threads_folder(), false);
    if (removed != asked.end() && removed->is_boolean()) {
      rig::SystemClock clock;
      if (*removed == true)
        library.remove(number->get<int>(), clock.utc());
      else
        library.restore(number->get<int>());
    } else {
      const Sample sample = sample_of_form(asked);
      if (asked.contains("tags")) library.tag(number->get<int>(), tags_of(text_of(asked, "tags")));
      library.edit(number->get<int>(), sample);
    }
  } catch (const Refused&) {
    throw;
  } catch (const std::runtime_error& problem) {
    throw Refused(409, problem.what());
  }
  changed_();
  return said(200, removed == asked.end() ? "written" : *removed == true ? "taken out of the library" : "put back");
}

// Under its own name as long as it is read, because that is what is said where it cannot be.
HttpResponse TechnicianPage::import_thread(const json& asked) {
  const std::string text = text_of(asked, "thread"), sample = text_of(asked, "sample");
  if (text.empty()) throw Refused(400, "expected \"thread\": the text of a thread file");
  const fs::path folder = workspace_.folder() / "jobs" / "import", file = folder / name_of(asked, "name");
  int number = 0;
  try {
    const fs::path sample_file = folder / "of its spool" / "sample.json";
    fs::create_directories(sample_file.parent_path());
    write_text_file(file, text);
    std::optional<Sample> told;
    if (!sample.empty()) {
      write_text_file(sample_file, sample);
      told = sample_of_form(to_json(read_sample_file(sample_file)));
    }
    rig::SystemClock clock;
    Library library(workspace_.threads_folder(), true);
    number = library.add(file, clock.utc()).number;
    if (told) library.edit(number, *told);
  } catch (const std::runtime_error& problem) {
    fs::remove_all(folder);
    throw Refused(409, problem.what());
  }
  fs::remove_all(folder);
  changed_();
  HttpResponse response =
      answered({{"message", "in the library as number " + std::to_string(number)}, {"number", number}});
  return response;
}

HttpResponse TechnicianPage::look(const json& asked) {
  if (!asked.contains("ended")) return answered({{"look", look_.show(asked)}});
  look_.end();
  return said(200, "the look has ended");
}

HttpResponse TechnicianPage::answer(const json& asked) {
  const std::shared_ptr<Job> running = running_job();
  const auto question = asked.find("question"), answer = asked.find("answer");
  if (question == asked.end() || !question->is_number_integer() || answer == asked.end() || !answer->is_string() ||
      answer->get_ref<const std::string&>().size() > kLongestText)
    throw Refused(400, "expected \"question\": the id of what was asked, and \"answer\": a text that it takes");
  if (!running->answer(question->get<int>(), answer->get<std::string>()))
    throw Refused(409, "that question is not open any more, or does not take this answer; read what is asked now");
  changed_();
  return said(200, "answered");
}

HttpResponse TechnicianPage::take_control(const json& asked) {
  const std::string client = text_of(asked, "client");
  if (client.empty() || client.size() > kLongestClient) throw Refused(400, "expected \"client\": a name of its own");
  const auto take = asked.find("take");
  {
    const std::scoped_lock lock(mutex_);
    if (!controller_.empty() && controller_ != client && !(take != asked.end() && *take == true))
      throw Refused(409, "another browser is in control");
    controller_ = client;
  }
  changed_();
  return said(200, "in control");
}

json TechnicianPage::state() {
  json document = workspace_.contents();
  document["rig"] = rig_.name;
  document["drafts"] = ready_drafts();
  document["ready_threads"] = ready_threads();
  document["shapes"] = cloth_shapes();
  document["fibers"] = fiber_kinds();
  document["export_formats"] = export_formats();
  document["simulated_spools"] = rig_.simulation ? simulated_spools() : std::vector<std::string>();
  document["calibration_valid_days"] = rig_.calibration_valid_days;
  document["devices"] = devices_summary(workspace_);
  document["job"] = nullptr;
  const std::shared_ptr<Job> of = job();
  if (of) document["job"] = of->state();
  pictures_.mark(document["threads"], !(of && of->running()) && look_.state()["running"] == false);
  const std::scoped_lock lock(mutex_);
  if (!document["job"].is_null()) document["job"].update({{"number", jobs_}, {"kind", job_kind_}});
  document["control"] = controller_;
  return document;
}

json TechnicianPage::bench() {
  json document = checked_devices(workspace_, rig_);
  document["frame"] = frame_.document();
  return document;
}

HttpResponse TechnicianPage::report(const std::string& name) const {
  const fs::path file = workspace_.session(checked_name(name)) / "report.html";
  if (!fs::is_regular_file(file)) throw Refused(404, "the session " + name + " has no report yet");
  return own_page(text_of_file(file));
}

HttpResponse TechnicianPage::calibration_report(const std::string& name) const {
  const fs::path file = workspace_.existing_calibration(name) / "calibration.html";
  if (!fs::is_regular_file(file)) throw Refused(404, "the calibration " + name + " has no report");
  return own_page(text_of_file(file));
}

// The camera is the next job's as soon as the live view has left it.
void TechnicianPage::end_live_view() {
  constexpr auto kLongest = std::chrono::seconds(10);
  std::shared_ptr<Job> live;
  {
    const std::scoped_lock lock(mutex_);
    if (job_kind_ == kLiveView) live = job_;
  }
  if (!live || !live->running()) return;
  live->pause();
  const auto end = std::chrono::steady_clock::now() + kLongest;
  while (live->running() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

HttpResponse TechnicianPage::start(const json& asked) {
  const JobCommand command = job_command(asked, workspace_, rig_file_);
  const int stops = [&] {
    const std::scoped_lock lock(mutex_);
    return stops_;
  }();
  end_live_view();
  {
    const std::scoped_lock lock(mutex_);
    if (stops_ != stops) throw Refused(409, "stopped before it began; start it again when it is safe");
    if (job_ && job_->running()) throw Refused(409, "a job is running; wait for it, or pause it");
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto number = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
    forget_old_jobs(workspace_.folder() / "jobs");
    job_kind_ = text_of(asked, "kind");
    job_said_ = workspace_.folder() / "jobs" / (std::to_string(number) + "-" + job_kind_);
    job_ = std::make_shared<Job>(
        JobRequest{.title = command.title, .steps = command.steps, .said = job_said_, .program = program_}, changed_);
    ++jobs_;
  }
  changed_();
  return said(200, "started");
}

}  // namespace station
