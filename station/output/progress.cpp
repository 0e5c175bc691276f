#include "station/output/progress.h"

#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

namespace station {
namespace {

std::string duration(double seconds) {
  const int whole = static_cast<int>(seconds + 0.5);
  if (whole < 60) return std::to_string(whole) + " s";
  return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
}

std::string bar(int done, int total) {
  constexpr int kWidth = 24;
  const int filled = kWidth * done / total;
  return "[" + std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(kWidth - filled), '.') + "]";
}

}  // namespace

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

ProgressDisplay::ProgressDisplay(std::string task, ProgressStyle style, Clock clock)
    : task_(std::move(task)),
      style_(style),
      terminal_(::isatty(STDERR_FILENO) == 1),
      clock_(std::move(clock)),
      start_(clock_()) {}

ProgressDisplay::~ProgressDisplay() {
  if (open_line_) std::fputc('\n', stderr);
}

void ProgressDisplay::show(int done, int total, const std::string& label, double seconds_left) {
  if (style_ == ProgressStyle::quiet) return;
  const std::lock_guard lock(mutex_);
  const double elapsed = seconds();
  if (!first_) first_ = done;
  if (seconds_left < 0 && done > *first_) seconds_left = elapsed / (done - *first_) * (total - done);
  if (style_ == ProgressStyle::json_lines) {
    nlohmann::json line{{"task", task_}, {"done", done}, {"total", total}, {"label", label}};
    if (seconds_left >= 0) line["seconds_left"] = seconds_left;
    std::fprintf(stderr, "%s\n", line.dump().c_str());
    return;
  }
  const std::string left = seconds_left >= 0 ? ", " + duration(seconds_left) + " left" : "";
  const std::string count = total > 0 ? std::to_string(done) + "/" + std::to_string(total) + " " : "";
  if (terminal_) {
    const std::string drawn = total > 0 ? bar(done, total) + " " : "";
    std::fprintf(stderr, "\r\033[K%s %s%s%s%s", task_.c_str(), drawn.c_str(), count.c_str(), label.c_str(),
                 left.c_str());
    open_line_ = true;
  } else {
    std::fprintf(stderr, "%s %s%s%s\n", task_.c_str(), count.c_str(), label.c_str(), left.c_str());
  }
  std::fflush(stderr);
}

double ProgressDisplay::seconds() const {
  return std::chrono::duration<double>(clock_() - start_).count();
}

void ProgressDisplay::note(const std::string& text) {
  if (style_ == ProgressStyle::quiet) return;
  const std::lock_guard lock(mutex_);
  if (style_ == ProgressStyle::json_lines)
    std::fprintf(stderr, "%s\n", nlohmann::json{{"task", task_}, {"note", text}}.dump().c_str());
  else
    std::fprintf(stderr, "%s%s: %s\n", open_line_ ? "\r\033[K" : "", task_.c_str(), text.c_str());
  open_line_ = false;
}

void ProgressDisplay::finish(const std::string& summary) {
  if (style_ != ProgressStyle::automatic) return;
  const std::lock_guard lock(mutex_);
  std::fprintf(stderr, "%s%s: %s\n", open_line_ ? "\r\033[K" : "", task_.c_str(), summary.c_str());
  open_line_ = false;
}

}  // namespace station
