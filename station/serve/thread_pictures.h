// Pictures of threads that came into the library without a session: each is woven into a small swatch, one after the
// other, by `threadstation cloth` while no job runs.
//
//   <workspace>/pictures/<sha256 of the thread file>.png
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "station/serve/job.h"
#include "station/serve/workspace.h"

namespace station {

class ThreadPictures {
 public:
  // `changed` is called, from another thread, when a picture has come. `workspace` must outlive it.
  ThreadPictures(const Workspace& workspace, std::function<void()> changed, std::filesystem::path program);
  ~ThreadPictures();  // gives up the one that is being made
  ThreadPictures(const ThreadPictures&) = delete;
  ThreadPictures& operator=(const ThreadPictures&) = delete;

  // Gives each line of Workspace::thread_lines() "pictured": whether its thread has a session or a picture here. Where
  // `may_make`, the next one that is missing is begun, but no second time after an end without a picture; otherwise the
  // one that is being made is given up.
  void mark(nlohmann::json& thread_lines, bool may_make);

 private:
  void make(int number, const std::string& sha256);
  void keep_made();
  std::filesystem::path cloth() const;  // folder of what is being made

  const Workspace& workspace_;
  const std::function<void()> changed_;
  const std::filesystem::path program_;
  std::mutex mutex_;
  std::unique_ptr<Job> job_;
  std::string making_;     // sha256 of the thread
  bool given_up_ = false;  // and the process told so
  std::set<std::string> in_vain_;
};

}  // namespace station
