// The lab's collection of digitized threads: a folder with an index of spools, sessions and threads (SQLite).
//
//   <library>/index.sqlite   tables spools, sessions, threads; can be made again from the sessions. A thread that was
//                            taken out keeps its row, with the time
//   <library>/threads/<number>.json   thread files as they were added
//
// Errors: std::runtime_error, one line: the library, what was found and what to do.
#pragma once

#include <Eigen/Core>
#include <array>
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
  std::string thread_name, added_utc, sha256;  // the thread file's
  std::string session, session_utc;            // where it was captured; empty for a lone thread file
  std::optional<double> relative_rmse;         // the fit's
  double diameter_mm = 0;
  std::vector<std::string> tags{};  // words of the lab's own
  // Nothing where no search has asked for them yet, in a library of an earlier version.
  std::optional<Eigen::Vector3d> lab{};   // of colour_of (thread_colour.h)
  std::optional<double> highlight_rad{};  // the width of its highlight along the thread, alpha of R
  std::optional<double> distance{};       // from the colour that was looked for
};

// What threads are looked for by; all of it must hold.
struct LibraryQuery {
  std::string words;                        // each in one of the thread's texts, case ignored (of ASCII letters)
  std::optional<Eigen::Vector3d> near_lab;  // the nearest first
  double within = 10;                       // their largest distance in CIE 1976 Lab, D50
  // Least and most.
  std::optional<std::array<double, 2>> diameter_mm, highlight_rad, relative_rmse;
  int most = 0;  // threads; 0: all
};

// The tags in a text where they are parted by commas: without empty ones and repetitions. Errors: std::runtime_error
// for more than 20, or one of more than 40 bytes.
std::vector<std::string> tags_of(const std::string& text);

class Library {
 public:
  // Opens the library; makes the folder and the index when they are missing and `make` allows it.
  Library(const std::filesystem::path& folder, bool make);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  // Adds a session with result/thread.json, or a thread file, and returns its entry. `utc` is the time now. Errors: as
  // above, also for a thread file that the library has already.
  LibraryThread add(const std::filesystem::path& session_or_thread, const std::string& utc);
  // The threads in the order of their numbers, or by their distance from a colour.
  std::vector<LibraryThread> find(const LibraryQuery& query) const;
  std::vector<LibraryThread> list(const std::string& words = {}) const { return find({.words = words}); }
  LibraryThread show(int number) const;  // one entry
  // What the lab knows of the thread's spool, written anew; other threads of the same spool (barcode, name and lot)
  // share it only as long as these three are the same. Errors: as above, also for a sample without any name.
  LibraryThread edit(int number, const Sample& sample);
  LibraryThread tag(int number, const std::vector<std::string>& tags);  // in place of those that it had
  // Takes a thread out of the list, and puts it back; its file and its number stay. Errors: as above, also where it is
  // out, or in, already.
  void remove(int number, const std::string& utc);
  void restore(int number);
  // Writes thread.json, sample.json and the hashes of both (manifest.json) into a new or empty folder. Errors: as
  // above, also when the file in the library is not what was added.
  void export_thread(int number, const std::filesystem::path& out) const;
  std::filesystem::path thread_file(int number) const;  // path of a thread's file in the library

 private:
  class Index;
  void measure_all() const;  // colours and highlights that are not known yet
  void set_removed(int number, const std::string& utc);
  std::filesystem::path folder_;
  std::unique_ptr<Index> index_;
};

}  // namespace station
