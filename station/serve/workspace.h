// The folder that the technician's page works in, and what it holds now, as JSON.
//
//   calibrations/<name>/   made by calibrate            sessions/<name>/   made by capture
//   spools/<name>.json     spool files                  samples/<name>.json  what the lab knows of that spool
//   queues/<name>.csv      tables of spools             library/           digitized threads
//   exports/<name>/        made by export               jobs/              what each job said
//   designs/<name>/        made by cloth, of threads in the library
//   pictures/              thread_pictures.h
//   look/                  made by look, of the cloth that is designed now
//   rigs/<name>.json       made by rig new              preview.jpg          the camera's live view
//   batches/<name>/        made by batch
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "station/serve/calibration_line.h"

namespace station {

class Workspace {
 public:
  // Makes its folders. Errors: std::runtime_error when they cannot be made.
  explicit Workspace(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  // Names must have been checked (page_answers.h).
  std::filesystem::path calibration(const std::string& name) const { return folder_ / "calibrations" / name; }
  std::filesystem::path session(const std::string& name) const { return folder_ / "sessions" / name; }
  std::filesystem::path spool(const std::string& name) const { return folder_ / "spools" / (name + ".json"); }
  std::filesystem::path sample(const std::string& name) const { return folder_ / "samples" / (name + ".json"); }
  std::filesystem::path queue(const std::string& name) const { return folder_ / "queues" / (name + ".csv"); }
  std::filesystem::path threads_folder() const { return folder_ / "library"; }
  // The file of a thread in the library; refuses numbers that it does not have.
  std::filesystem::path thread_in_library(int number) const;
  std::filesystem::path exported(const std::string& name) const { return folder_ / "exports" / name; }
  std::filesystem::path batch(const std::string& name) const { return folder_ / "batches" / name; }
  std::filesystem::path design(const std::string& name) const { return folder_ / "designs" / name; }
  // Of a thread without a session, by the hash of its file; it need not be there.
  std::filesystem::path thread_picture(const std::string& sha256) const {
    return folder_ / "pictures" / (sha256 + ".png");
  }
  std::filesystem::path rig(const std::string& name) const { return folder_ / "rigs" / (name + ".json"); }
  std::filesystem::path preview() const { return folder_ / "preview.jpg"; }

  // A line for each thread of the library: {"number", "name", "sample", "added_utc", "diameter_mm", "session" (its
  // folder's name), "sha256" (of its file), "tags", "relative_rmse"}.
  nlohmann::json thread_lines() const;
  // {"calibrations" (calibration_line.h), "spools", "sessions", "threads", "queues", "exports", "designs"}, the last
  // each {"name", "draft", "threads" (names of warp and weft), "pictures" (their shapes), "made" (what changes when it
  // is made anew)}
  nlohmann::json contents();
  // One session: its line in contents(), and "views" with "number", "step", "grade", "reason", "picture" (which file it
  // is, absent without one). Throws Refused (404) when there is none.
  nlohmann::json session_document(const std::string& name);
  // Throws Refused (404) when there is no such session.
  std::filesystem::path existing_session(const std::string& name) const;
  std::filesystem::path existing_calibration(const std::string& name) const;  // likewise
  // What a session still lacks of "capture", "develop", "invert", "report" and "add" (to the library). What is older
  // than what it was made from is lacking.
  std::set<std::string> work_left(const std::string& name) const;

 private:
  // `fits`: the hashes of the fits that the library holds.
  nlohmann::json session_line(const std::filesystem::path& folder, const std::set<std::string>& fits);
  std::set<std::string> left_of(const std::filesystem::path& session, bool complete,
                                const std::set<std::string>& fits) const;
  std::string fit_hash(const std::filesystem::path& session) const;  // empty: not fitted
  nlohmann::json queue_line(const std::string& name);

  std::filesystem::path folder_;
  // The line of a session, which holds while its journal's length and time, and whether a process has it open, are
  // these.
  struct ReadSession {
    std::uintmax_t journal_bytes = 0;
    std::filesystem::file_time_type journal_time{};
    bool in_use = false;
    nlohmann::json line;
  };
  std::mutex sessions_mutex_;
  std::map<std::string, ReadSession> sessions_;
  struct ReadFit {
    std::filesystem::file_time_type time{};
    std::string sha256;
  };
  mutable std::mutex fits_mutex_;
  mutable std::map<std::string, ReadFit> fits_;  // of each session, while its file has that time
  CalibrationLines calibrations_;
};

// The names of the folders in `folder` that may be parts of paths, sorted.
std::vector<std::string> folders_in(const std::filesystem::path& folder);
// Likewise of the files with this ending, without it.
std::vector<std::string> files_in(const std::filesystem::path& folder, const std::string& ending);

}  // namespace station
