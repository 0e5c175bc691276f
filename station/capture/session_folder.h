// A session folder (architecture.md): what was asked, what happened, and the pictures as the camera delivered them.
//
//   session.json   written once, last of all when the folder is made: where it stands, the folder is whole
//   journal.jsonl  station/capture/journal.h
//   raw/ calibration/ linear/ masks/ result/
//   refused/       pictures that did not serve or count no more; never deleted, never read again
//   .lock          one process at a time
//
// Errors: std::runtime_error with one line: the file or folder, what was found, what to do.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "rig/clock.h"
#include "station/capture/file_system.h"
#include "station/capture/journal.h"
#include "station/capture/plan.h"

namespace station {

using CalibrationFiles = std::map<std::string, std::vector<std::byte>>;  // file name -> content

// "Already a session" is told apart from other errors: the person may want to resume it.
bool is_session(const std::filesystem::path& folder);

class SessionFolder {
 public:
  // `session` is a document of kind "session", version 1, whose key "plan" is a plan document (plan_file.h); the
  // other keys are the caller's. A folder that is there must be empty, or what an interrupted create left. The clock
  // and the file system must outlive the session folder.
  static SessionFolder create(const std::filesystem::path& folder, const nlohmann::json& session,
                              const CalibrationFiles& calibration, rig::Clock& clock, FileSystem& file_system);

  // To go on with a session: cuts a torn journal line and removes what a killed process left at temporary names, and
  // journals both.
  static SessionFolder open(const std::filesystem::path& folder, rig::Clock& clock, FileSystem& file_system);

  const std::filesystem::path& path() const { return path_; }
  const nlohmann::json& session() const { return session_; }
  const Plan& plan() const { return plan_; }
  const std::vector<JournalRecord>& records() const { return journal_.records(); }

  // From any thread.
  void append(std::string_view event, const nlohmann::json& data) { journal_.append(event, data); }
  // The last record of this process: whatever another thread appends after it is refused.
  void append_last(std::string_view event, const nlohmann::json& data) { journal_.append_last(event, data); }

  // raw/<name>, whole and flushed when this returns its SHA-256. A picture is never overwritten.
  std::string store_picture(const std::string& name, std::span<const std::byte> bytes);
  // Moves raw/<name> to refused/, under a name that is free there; nothing when it is not there.
  void set_aside(const std::string& name);
  struct Stored {
    std::string file, sha256;  // in the session folder
  };
  Stored store_refused(const std::string& name, std::span<const std::byte> bytes);
  std::vector<std::string> picture_names() const;  // all of raw/, sorted

  // SHA-256 of what stays as it was made: session.json and calibration/*, by path in the session folder.
  std::map<std::string, std::string> hashes_of_fixed_files() const;

 private:
  std::filesystem::path free_place(const std::string& name) const;
  SessionFolder(const std::filesystem::path& folder, OpenFile lock, rig::Clock& clock, FileSystem& file_system);

  std::filesystem::path path_;
  OpenFile lock_;
  FileSystem* file_system_;
  nlohmann::json session_;
  Plan plan_;
  Journal journal_;
};

}  // namespace station
