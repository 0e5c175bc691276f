// Progress of long work on standard error: a bar with the time left on a terminal, plain lines otherwise.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace station {

enum class ProgressStyle { automatic, quiet, json };  // automatic: bar on a terminal, lines elsewhere

class ProgressDisplay {
 public:
  explicit ProgressDisplay(std::string task, ProgressStyle style = ProgressStyle::automatic);
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  // `done` of `total` units are finished; `label` says what comes now. The time left is guessed from the pace so far
  // unless it is given.
  void show(int done, int total, const std::string& label, double seconds_left = -1);
  // A line that stays, from any thread.
  void note(const std::string& text);
  void finish(const std::string& summary);

 private:
  std::string task_;
  ProgressStyle style_;
  bool terminal_;
  std::mutex mutex_;
  bool open_line_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace station
