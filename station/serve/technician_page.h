// What the technician's page asks and what is done about it, without the network: files of the page, what the workspace
// (workspace.h) holds, and one job at a time.
//
//   GET  /                     the page; its other files by their names
//   GET  /api/state            {"rig", "job", "control", "drafts", "shapes", "export_formats", "simulated_spools",
//                              "calibration_valid_days", "devices": {"passed" (null: never checked), "checked_ms"},
//                              and the workspace's contents}
//   GET  /api/events           event stream: a line when something has changed
//   GET  /api/bench            {"frame": last_frame.h, "devices": as `check` found them last, "checked_ms": when}
//   GET  /api/calibration?name= calibration_line.h
//   GET  /api/session?name=    workspace.h
//   GET  /api/result?name=     result_document.h, of a session
//   GET  /api/thread?number=   result_document.h, of a thread in the library; with=: of another one, the difference
//   GET  /api/lots             result_document.h, of the lots in the library
//   GET  /api/look             design_look.h
//   GET  /label?number=        label.h, of a thread in the library
//   GET  /picture?of=...       page_pictures.h; of=look: the cloth that is designed now
//   GET  /report?name=         the session's report.html
//   GET  /calibration?name=    the calibration's calibration.html
//   GET  /download?name=       exports/<name> as a ZIP archive
//   POST /api/control {"client", "take"}          one browser controls, the others watch
//   POST /api/job {"client", "kind", ...}         job_command.h; a live view ends for it
//   POST /api/spool {"client", ...}               spool_form.h
//   POST /api/thread {"client", "number", "removed": whether it is out of the library | the fields of its sample,
//                     "tags": parted by commas; may be left out}
//   POST /api/import {"client", "name": of the file, "thread": the text of a thread file, "sample": of a sample file;
//                     may be left out} adds a thread of another station to the library
//   POST /api/look {"client", "ended": true | design_look.h}  answers {"look"}
//   POST /api/answer {"client", "question", "answer"}  to the question with this id that the job asks (job.h)
//   POST /api/pause {"client"}
//   POST /api/stop          emergency stop: any browser's, at once, also of a job that an earlier server has left
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "station/documents/rig_file.h"
#include "station/serve/design_look.h"
#include "station/serve/http_message.h"
#include "station/serve/job.h"
#include "station/serve/last_frame.h"
#include "station/serve/thread_pictures.h"
#include "station/serve/workspace.h"

namespace station {

class TechnicianPage {
 public:
  // Makes the workspace's folders. `changed` is called, from any thread, when /api/state is different. Errors:
  // std::runtime_error for a rig file or workspace that cannot be used, and without what comes with the program.
  TechnicianPage(const std::filesystem::path& rig, const std::filesystem::path& workspace,
                 std::function<void()> changed, std::filesystem::path program = kThisProgram);

  // The answer to an emergency stop; nothing for any other request. It waits for nothing but two signals.
  std::optional<HttpResponse> urgent(const HttpRequest& request);
  HttpResponse handle(const HttpRequest& request);

 private:
  HttpResponse get(const HttpRequest& request);
  HttpResponse post(const HttpRequest& request);
  nlohmann::json state();
  nlohmann::json bench();
  HttpResponse report(const std::string& name) const;
  HttpResponse calibration_report(const std::string& name) const;
  HttpResponse take_control(const nlohmann::json& asked);
  HttpResponse start(const nlohmann::json& asked);
  HttpResponse answer(const nlohmann::json& asked);
  HttpResponse change_thread(const nlohmann::json& asked);
  HttpResponse import_thread(const nlohmann::json& asked);
  HttpResponse look(const nlohmann::json& asked);
  void end_live_view();
  bool in_control(const nlohmann::json& asked) const;
  std::shared_ptr<Job> job() const;
  std::shared_ptr<Job> running_job() const;  // throws Refused (409) when nothing is running

  std::filesystem::path rig_file_, program_;
  RigFile rig_;
  Workspace workspace_;
  LastFrame frame_;
  DesignLook look_;
  ThreadPictures pictures_;
  std::function<void()> changed_;
  mutable std::mutex mutex_;
  std::shared_ptr<Job> job_;
  std::string job_kind_;
  std::filesystem::path job_said_;  // JobRequest::said
  int jobs_ = 0;                    // that were started
  int stops_ = 0;                   // emergency stops that were asked for; a job is not started over one
  std::string controller_;          // client in control; empty: nobody yet
};

}  // namespace station
