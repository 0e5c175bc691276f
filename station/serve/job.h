// One command of the program that the page has started: a process of its own, so that neither the page nor this server can
// hold it up, and so that it goes on when both are gone. What it says is kept in two files.
//
// It is told as anybody at a terminal would: questions come on its output and are answered on its input, ctrl-C is a signal.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace station {

inline constexpr const char* kThisProgram = "/proc/self/exe";

struct JobRequest {
  std::string title;
  std::vector<std::string> arguments;  // of this program; --json is added
  std::filesystem::path said;          // said.out and said.progress are written
  std::filesystem::path program = kThisProgram;
};

class Job {
 public:
  // Starts it. `changed` is called from another thread after each change. Errors: std::runtime_error when the process or
  // its files cannot be made.
  Job(const JobRequest& request, std::function<void()> changed);
  ~Job();  // leaves the process alone; a question of its is then declined
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  bool running() const;
  // {"title", "running", "status" (of its exit; null before), "done", "total", "label", "seconds_left", "question" (what is to be
  // done, or null), "asked" (how many questions there were so far), "arrangement" (drawing_operator.h: what the bench was last asked to be; null before), "lines" (the last
  // that were said to people)}
  nlohmann::json state() const;

  // Of the question of this number ("asked" of the state): it is done, or the person declines. False, and nothing is done,
  // when that question is not open: a second click on the same button must not answer the next one.
  bool answer(int question, bool done);
  void pause();            // ctrl-C: at the next safe point
  void stop_now();         // both ctrl-C: the platform stops at once, whatever is under way is given up

 private:
  class Process;
  std::unique_ptr<Process> process_;
};

}  // namespace station
