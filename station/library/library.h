// The lab's collection: a folder of digitized threads with an index of spools, sessions and threads (SQLite).
//
//   <library>/index.sqlite   tables spools, sessions, threads; what is in them can be made again from the sessions
//   <library>/threads/<number>.json   thread files as they were added
//
// Errors: std::runtime_error, one line: the library, what was found and what to do.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "station/documents/sample.h"

namespace station {

struct LibraryThread {
  int number = 0;  // in the library, from 1
  Sample sample;
  std::string thread_name, added_utc, sha256;  // of the thread file
  std::string session, session_utc;            // where it was captured; empty for a thread file alone
  std::optional<double> relative_rmse;         // of its fit
  double diameter_mm = 0;
};

class Library {
 public:
  // Makes the folder and the index when they are not there and `make` allows it.
  Library(const std::filesystem::path& folder, bool make);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  // A session with result/thread.json, or a thread file. `utc`: now. Refused: the same thread file twice.
  LibraryThread add(const std::filesystem::path& session_or_thread, const std::string& utc);
  // In the order of their numbers; `words`: only those with this text in one of their texts, case ignored.
  std::vector<LibraryThread> list(const std::string& words = {}) const;
  LibraryThread show(int number) const;
  // thread.json and sample.json with the hashes of both (manifest.json), in a new or empty folder. Refused when the file
  // in the library is not what was added.
  void export_thread(int number, const std::filesystem::path& out) const;
  std::filesystem::path thread_file(int number) const;

 private:
  class Index;
  std::filesystem::path folder_;
  std::unique_ptr<Index> index_;
};

}  // namespace station
