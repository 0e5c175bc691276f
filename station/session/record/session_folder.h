// A session folder: what was asked, what happened, and the pictures as the camera delivered them.
//
//   session.json   written once, last of all when the folder is made: where it is present, the folder is whole
//   journal.jsonl  what happened (station/session/record/journal.h)
//   raw/ calibration/ linear/ masks/ result/
//   refused/       pictures that were refused or count no more; never deleted, never read again
//   .lock          held by the one process that works on the session
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

#include "rig/devices/clock.h"
#include "station/documents/disk/file_system.h"
#include "station/documents/plan.h"
#include "station/session/record/journal.h"

namespace station {

using CalibrationFiles = std::map<std::string, std::vector<std::byte>>;  // file name -> content

// Whether the folder is a session already, for callers that then offer to resume it.
bool is_session(const std::filesystem::path& folder);

class SessionFolder {
 public:
  // Makes a session folder. `session` is a document of kind "session", version 1, whose key "plan" is a plan document
  // (plan_file.h); the other keys are the caller's. A folder that exists must be empty, or left by an interrupted
  // create. The clock and the file system must outlive the session folder.
  static SessionFolder create(const std::filesystem::path& folder, const nlohmann::json& session,
                              const CalibrationFiles& calibration, rig::Clock& clock, FileSystem& file_system);

  // Opens a session to go on with it: cuts off a torn journal line, removes temporary files that a killed process left,
  // and journals both.
  static SessionFolder open(const std::filesystem::path& folder, rig::Clock& clock, FileSystem& file_system);

  const std::filesystem::path& path() const { return path_; }
  const nlohmann::json& session() const { return session_; }
  const Plan& plan() const { return plan_; }
  const std::vector<JournalRecord>& records() const { return journal_.records(); }

  // Append a record to the journal, from any thread; append_last's is the last one of this process, and whatever
  // another thread appends after it is refused.
  void append(std::string_view event, const nlohmann::json& data) { journal_.append(event, data); }
  void append_last(std::string_view event, const nlohmann::json& data) { journal_.append_last(event, data); }

  // Stores a picture as raw/<name> and returns its SHA-256 when the file is on the disk. A picture is never
  // overwritten.
  std::string store_picture(const std::string& name, std::span<const std::byte> bytes);
  // Moves raw/<name> to refused/, under a name that is free there; does nothing when the file is missing.
  void set_aside(const std::string& name);
  struct Stored {
    std::string file, sha256;  // `file` relative to the session folder
  };
  Stored store_refused(const std::string& name, std::span<const std::byte> bytes);  // under a free name in refused/
  std::vector<std::string> picture_names() const;                                   // all of raw/, sorted

  // The SHA-256 of the files that never change, session.json and calibration/*, by path relative to the session folder.
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
