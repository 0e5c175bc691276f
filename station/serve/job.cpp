#include "station/serve/job.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>

#include "station/serve/left_jobs.h"

extern char** environ;

namespace station {
namespace {

constexpr std::size_t kMostLines = 200, kMostText = 4000, kMostLine = 1 << 20;
constexpr auto kBetweenSignals = std::chrono::milliseconds(20), kBetweenLooks = std::chrono::milliseconds(100);

std::filesystem::path with_ending(std::filesystem::path file, const char* ending) {
  return file += ending;
}

// A file that grows line by line, as far as it has been read.
class Growing {
 public:
  explicit Growing(std::filesystem::path file) : file_(std::move(file)) {}

  // The lines that have ended since the last call.
  std::vector<std::string> more() {
    std::ifstream stream(file_, std::ios::binary);
    stream.seekg(read_);
    const std::size_t known = open_.size();
    open_.append(std::istreambuf_iterator<char>(stream), {});
    read_ += static_cast<std::streamoff>(open_.size() - known);
    std::vector<std::string> lines;
    for (std::size_t end = 0; (end = open_.find('\n')) != std::string::npos; open_.erase(0, end + 1))
      lines.push_back(open_.substr(0, end));
    if (open_.size() > kMostLine) open_.erase(1, open_.size() - kMostLine);  // its beginning says what it is
    return lines;
  }

 private:
  std::filesystem::path file_;
  std::streamoff read_ = 0;
  std::string open_;
};

// A choice that the question offers, or any text where one may be typed.
bool takes(const nlohmann::json& question, const std::string& answer) {
  if (question.contains("typed")) return true;
  const nlohmann::json choices = question.value("choices", nlohmann::json::array());
  return std::ranges::any_of(choices, [&](const nlohmann::json& one) { return one.value("answer", "") == answer; });
}

}  // namespace

class Job::Process {
 public:
  Process(const JobRequest& request, std::function<void()> changed)
      : request_(request),
        changed_(std::move(changed)),
        output_(with_ending(request.said, ".out")),
        progress_(with_ending(request.said, ".progress")),
        process_file_(with_ending(request.said, kProcessFile)) {
    for (const char* ending : {".out", ".progress"})
      std::ofstream(with_ending(request.said, ending), std::ios::trunc).flush();
    start();
    follower_ = std::jthread([this](const std::stop_token& stop) { follow(stop); });
  }

  ~Process() {
    follower_.request_stop();
    if (follower_.joinable()) follower_.join();
    if (input_ >= 0) close(input_);
  }

  bool running() const {
    const std::scoped_lock lock(mutex_);
    return !status_;
  }

  nlohmann::json state() const {
    const std::scoped_lock lock(mutex_);
    nlohmann::json state{{"title", request_.title}, {"running", !status_}, {"status", nullptr},
                         {"outcome", nullptr},      {"done", done_},       {"total", total_},
                         {"label", label_},         {"task", task_},       {"seconds_left", nullptr},
                         {"question", question_},   {"lines", lines_},     {"steps", nlohmann::json::array()}};
    if (status_) state["status"] = *status_;
    if (status_) state["outcome"] = outcome();
    for (std::size_t i = 0; i < request_.steps.size(); ++i)
      state["steps"].push_back({{"kind", request_.steps[i].kind},
                                {"state", i < step_   ? "well"
                                          : i > step_ ? "waiting"
                                          : status_   ? outcome()
                                                      : "running"}});
    if (seconds_left_ >= 0) state["seconds_left"] = seconds_left_;
    return state;
  }

  bool answer(int id, const std::string& answer) {
    const std::string line = nlohmann::json{{"id", id}, {"answer", answer}}.dump() + "\n";
    const std::scoped_lock lock(mutex_);
    if (question_.is_null() || question_.at("id") != id || !takes(question_, answer) || gone_) return false;
    question_ = nullptr;
    write_line(line);  // a process that has gone is seen by the follower
    return true;
  }

  bool tell(const nlohmann::json& said) {
    const std::string line = said.dump() + "\n";
    const std::scoped_lock lock(mutex_);
    return !gone_ && !status_ && write_line(line);
  }

  nlohmann::json shown() const {
    const std::scoped_lock lock(mutex_);
    return shown_;
  }

  void signal(int times) {
    const std::scoped_lock lock(mutex_);
    if (status_) return;
    signals_ = std::max(signals_, times);
    for (int i = 0; i < times && !gone_; ++i) {
      if (i > 0) std::this_thread::sleep_for(kBetweenSignals);
      kill(process_, SIGINT);
    }
  }

 private:
  // Whole or not at all: it is shorter than what a pipe takes in one piece, and who does not read makes nobody wait.
  bool write_line(const std::string& line) const {
    return line.size() < PIPE_BUF && write(input_, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  }

  // Of a job that has ended.
  const char* outcome() const {
    return *status_ == 0 ? "well" : signals_ == 0 ? "badly" : signals_ == 1 ? "paused" : "stopped";
  }

  // Begins the step `step_`.
  void start() {
    std::vector<std::string> words = request_.steps[step_].arguments;
    words.insert(words.begin(), "threadstation");
    words.emplace_back("--json");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw std::runtime_error("cannot start " + request_.title + ": " + std::strerror(errno));
    fcntl(ends[1], F_SETFL, O_NONBLOCK);
    const std::filesystem::path out = with_ending(request_.said, ".out"),
                                progress = with_ending(request_.said, ".progress");
    constexpr int kAdd = O_WRONLY | O_CREAT | O_APPEND;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kAdd, 0644);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, progress.c_str(), kAdd, 0644);
    // Nothing else of ours: a connection that the process kept open would look alive to its browser for ever.
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // ctrl-C in the server's terminal is not the run's
    const int failed =
        posix_spawn(&process_, request_.program.c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    if (input_ >= 0) close(input_);
    input_ = ends[1];
    if (failed != 0) {
      close(input_);
      input_ = -1;
      throw std::runtime_error("cannot start " + request_.title + ": " + std::strerror(failed));
    }
    gone_ = false;
    note_process(process_file_, process_);
  }

  void follow(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      int status = 0;
      const bool ended = reaped(status);  // before the last look
      const bool said = look();
      if (ended) next(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), stop);
      if ((said && request_.watched) || ended) changed_();
      if (!running()) std::filesystem::remove(process_file_);
      if (!running()) return;
      std::this_thread::sleep_for(kBetweenLooks);
    }
  }

  // After a step has ended so: the next one, or the end.
  void next(int status, const std::stop_token& stop) {
    const std::scoped_lock lock(mutex_);
    question_ = nullptr;
    const bool last = step_ + 1 == request_.steps.size();
    if (status != 0 || last || signals_ > 0 || stop.stop_requested()) {
      // A step that was through when a person asked for a pause has not been paused, but what follows has.
      status_ = status == 0 && !last ? 1 : status;
      step_ += status == 0 && !last ? 1 : 0;
      return;
    }
    ++step_;
    done_ = total_ = 0;
    label_.clear(), task_.clear();
    seconds_left_ = -1;
    try {
      start();
    } catch (const std::runtime_error& problem) {
      add_line(problem.what());
      status_ = 1;
    }
  }

  bool reaped(int& status) {
    const std::scoped_lock lock(mutex_);
    gone_ = waitpid(process_, &status, WNOHANG) == process_;
    return gone_;
  }

  // True when there was something new.
  bool look() {
    const std::vector<std::string> said = output_.more(), progress = progress_.more();
    const std::scoped_lock lock(mutex_);
    for (const std::string& line : said) read_line(line);
    for (const std::string& line : progress) read_line(line);
    return !said.empty() || !progress.empty();
  }

  void add_line(const std::string& line) {
    if (line.empty()) return;
    lines_.push_back(line.substr(0, kMostText));
    if (lines_.size() > kMostLines) lines_.erase(lines_.begin());
  }

  // What is a document for machines no person should read; questions, notes and progress are taken out of it.
  void read_line(const std::string& line) {
    if (!line.starts_with('{') && !line.starts_with('[')) return add_line(line);
    const nlohmann::json said = nlohmann::json::parse(line, nullptr, false);
    if (!said.is_object()) return;
    if (said.contains("question") && said["question"].contains("id")) {
      question_ = said["question"];
      add_line(question_.value("text", ""));
    }
    const int open = question_.is_null() ? -1 : question_.value("id", -1);
    if (said.contains("answered") && said["answered"] == open) question_ = nullptr;
    if (said.contains("remark") && said["remark"].is_object() && said["remark"].value("id", -2) == open)
      question_["remark"] = said["remark"].value("text", "");
    if (said.contains("shown")) shown_ = said["shown"];
    if (said.contains("note") && said["note"].is_string()) add_line(said["note"].get<std::string>());
    if (!said.contains("done") || !said.contains("total")) return;
    done_ = said.value("done", 0), total_ = said.value("total", 0);
    label_ = said.value("label", "");
    task_ = said.value("task", "");
    seconds_left_ = said.value("seconds_left", -1.0);
  }

  const JobRequest request_;
  const std::function<void()> changed_;
  pid_t process_ = -1;
  int input_ = -1;
  Growing output_, progress_;  // the follower's
  const std::filesystem::path process_file_;

  mutable std::mutex mutex_;
  std::size_t step_ = 0;
  int signals_ = 0;  // the most that a person sent at once
  std::optional<int> status_;
  bool gone_ = false;  // its number may be another process's by now
  int done_ = 0, total_ = 0;
  double seconds_left_ = -1;
  std::string label_, task_;  // what is done now, and which stage of the command it belongs to
  std::vector<std::string> lines_;
  nlohmann::json question_;  // null: none is open
  nlohmann::json shown_;
  std::jthread follower_;
};

Job::Job(const JobRequest& request, std::function<void()> changed)
    : process_(std::make_unique<Process>(request, std::move(changed))) {}
Job::~Job() = default;

bool Job::running() const {
  return process_->running();
}

nlohmann::json Job::state() const {
  return process_->state();
}

bool Job::answer(int id, const std::string& answer) {
  return process_->answer(id, answer);
}

bool Job::tell(const nlohmann::json& line) {
  return process_->tell(line);
}

nlohmann::json Job::shown() const {
  return process_->shown();
}

void Job::pause() {
  process_->signal(1);
}

void Job::stop_now() {
  process_->signal(2);
}

}  // namespace station
