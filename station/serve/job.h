// What the page has started: commands of the program one after the other, each a process of its own, so that neither
// the page nor this server can hold it up, and so that it goes on when both are gone. What they say is kept in two
// files.
//
// It speaks JSON: its questions come on its output and are answered on its input (rig/people/asked_person.h). Ctrl-C is
// a signal.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace station {

inline constexpr const char* kThisProgram = "/proc/self/exe";

struct JobStep {
  std::string kind;                    // as the page names it (job_command.h)
  std::vector<std::string> arguments;  // of this program; --json is added
};

struct JobRequest {
  std::string title;
  std::vector<JobStep> steps;  // at least one; each begins when the one before has ended well
  std::filesystem::path said;  // said.out and said.progress are written; said.process while it runs
  bool watched = true;         // whether what it says is a change, or only the end of each step
  std::filesystem::path program = kThisProgram;
};

class Job {
 public:
  // Starts it. `changed` is called from another thread after each change (JobRequest::watched). Errors:
  // std::runtime_error when the first process or its files cannot be made.
  Job(const JobRequest& request, std::function<void()> changed);
  ~Job();  // leaves the process alone, and begins no further step; a question of its is then declined
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  bool running() const;
  // {"title", "running", "status" (of the last exit; null before), "outcome" (null, "well", "paused" or "stopped" by a
  // person, "badly"), "steps" [{"kind", "state": "waiting", "running" or an outcome}], "done", "total", "label",
  // "seconds_left", "question" (the one that is open, as the process asked it; null when there is none), "lines" (the
  // last that were said to people)}
  nlohmann::json state() const;

  // Answers the question with this id. False, and nothing is done, when another question is open or none (a second
  // click on the same button must not answer the next one), or when the question does not take this answer.
  bool answer(int id, const std::string& answer);
  // Says something that nobody asked for to a process that listens (cloth/preview/cloth_look.h). False when it does not
  // come through: the process has gone, or has left so much unread that it seems to.
  bool tell(const nlohmann::json& line);
  nlohmann::json shown() const;  // what such a process showed last, {"shown": this}; null before
  void pause();                  // ctrl-C: at the next safe point
  void stop_now();               // both ctrl-C: the platform stops at once, whatever is under way is given up

 private:
  class Process;
  std::unique_ptr<Process> process_;
};

}  // namespace station
