// What the technician's page asks and what is done about it, without the network: files of the page, what the workspace
// holds, and one job at a time.
//
//   <workspace>/calibrations/<name>/   made by calibrate       <workspace>/spools/*.json   spool files
//   <workspace>/sessions/<name>/       made by capture         <workspace>/library/        digitized threads
//   <workspace>/jobs/                  what each job said
//
//   GET  /                     the page; /app.js /style.css /texts.json its parts
//   GET  /api/state            {"rig", "job", "control", "calibrations", "spools", "sessions", "library"}
//   GET  /api/events           event stream: a line when something has changed
//   GET  /api/session?name=    {"name", "state", "views": [{"number", "step", "grade", "reason"}], ...}
//   GET  /report?name=         the session's report.html
//   POST /api/control {"client", "take"}          one browser controls, the others watch
//   POST /api/job {"client", "kind", "name", ...}  calibrate capture resume reshoot develop invert report
//   POST /api/answer {"client", "done"}           of the question that the job asks
//   POST /api/pause {"client"}
//   POST /api/stop                                 emergency stop: any browser's, at once
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "station/serve/http_message.h"
#include "station/serve/job.h"

namespace station {

class TechnicianPage {
 public:
  // `changed`: something of /api/state is another; called from any thread. Makes the workspace's folders. Errors:
  // std::runtime_error for a rig file or workspace that cannot be used.
  TechnicianPage(std::filesystem::path rig, std::filesystem::path workspace, std::function<void()> changed,
                 std::filesystem::path program = kThisProgram);

  // The emergency stop; none for any other request. Waits for nothing but two signals.
  std::optional<HttpResponse> urgent(const HttpRequest& request);
  HttpResponse handle(const HttpRequest& request);

 private:
  HttpResponse state();
  HttpResponse session(const std::string& name);
  HttpResponse report(const std::string& name) const;
  HttpResponse take_control(const nlohmann::json& asked);
  HttpResponse start(const nlohmann::json& asked);
  nlohmann::json session_line(const std::filesystem::path& folder);
  bool in_control(const nlohmann::json& asked) const;
  std::shared_ptr<Job> job() const;

  std::filesystem::path rig_, workspace_, program_;
  std::string rig_name_;
  std::function<void()> changed_;
  mutable std::mutex mutex_;
  std::shared_ptr<Job> job_;
  std::string controller_;  // client in control; empty: nobody yet

  // What was read of a session, good while its journal is as long and as old, and is held by a process or is not.
  struct ReadSession {
    std::uintmax_t journal_bytes = 0;
    std::filesystem::file_time_type journal_time{};
    bool in_use = false;
    nlohmann::json line;
  };
  std::mutex sessions_mutex_;
  std::map<std::string, ReadSession> sessions_;
};

}  // namespace station
