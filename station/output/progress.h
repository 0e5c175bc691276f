// Progress of long work on standard error: a bar with the time left on a terminal, plain lines otherwise.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace station {

double seconds_since(std::chrono::steady_clock::time_point begin);

enum class ProgressStyle { automatic, quiet, json_lines };  // automatic: bar on a terminal, lines elsewhere

class ProgressDisplay {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;
  explicit ProgressDisplay(std::string task, ProgressStyle style = ProgressStyle::automatic,
                           Clock clock = std::chrono::steady_clock::now);
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  // `done` of `total` units are finished (a total of 0: nobody knows); `label` says what comes now. The time left is
  // guessed from the pace since the first call (what goes on from an earlier run does not begin at 0) unless it is
  // given.
  void show(int done, int total, const std::string& label, double seconds_left = -1);
  // A line that stays, from any thread.
  void note(const std::string& text);
  void finish(const std::string& summary);
  double seconds() const;  // since it was made

 private:
  std::string task_;
  ProgressStyle style_;
  bool terminal_;
  Clock clock_;
  std::mutex mutex_;
  bool open_line_ = false;
  std::optional<int> first_;  // units that were done when this run began
  std::chrono::steady_clock::time_point start_;
};

}  // namespace station
