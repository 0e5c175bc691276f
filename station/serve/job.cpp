#include "station/serve/job.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
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
      : title_(request.title),
        changed_(std::move(changed)),
        output_(with_ending(request.said, ".out")),
        progress_(with_ending(request.said, ".progress")),
        process_file_(with_ending(request.said, kProcessFile)) {
    start(request);
    note_process(process_file_, process_);
    follower_ = std::jthread([this](const std::stop_token& stop) { follow(stop); });
  }

  ~Process() {
    follower_.request_stop();
    if (follower_.joinable()) follower_.join();
    close(input_);
  }

  bool running() const {
    const std::scoped_lock lock(mutex_);
    return !status_;
  }

  nlohmann::json state() const {
    const std::scoped_lock lock(mutex_);
    nlohmann::json state{{"title", title_},         {"running", !status_},   {"status", nullptr},
                         {"done", done_},           {"total", total_},       {"label", label_},
                         {"seconds_left", nullptr}, {"question", question_}, {"lines", lines_}};
    if (status_) state["status"] = *status_;
    if (seconds_left_ >= 0) state["seconds_left"] = seconds_left_;
    return state;
  }

  bool answer(int id, const std::string& answer) {
    const std::string line = nlohmann::json{{"id", id}, {"answer", answer}}.dump() + "\n";
    const std::scoped_lock lock(mutex_);
    if (question_.is_null() || question_.at("id") != id || !takes(question_, answer) || gone_) return false;
    question_ = nullptr;
    // Shorter than a pipe holds; a process that has gone is seen by the follower.
    [[maybe_unused]] const ssize_t written = write(input_, line.data(), line.size());
    return true;
  }

  void signal(int times) {
    const std::scoped_lock lock(mutex_);
    for (int i = 0; i < times && !gone_; ++i) {
      if (i > 0) std::this_thread::sleep_for(kBetweenSignals);
      kill(process_, SIGINT);
    }
  }

 private:
  void start(const JobRequest& request) {
    std::vector<std::string> words = request.arguments;
    words.insert(words.begin(), "threadstation");
    words.emplace_back("--json");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0)
      throw std::runtime_error("cannot start " + request.title + ": " + std::strerror(errno));
    const std::filesystem::path out = with_ending(request.said, ".out"),
                                progress = with_ending(request.said, ".progress");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, progress.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    // Nothing else of ours: a connection that the process kept open would look alive to its browser for ever.
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // ctrl-C in the server's terminal is not the run's
    const int failed =
        posix_spawn(&process_, request.program.c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    input_ = ends[1];
    if (failed == 0) return;
    close(input_);
    throw std::runtime_error("cannot start " + request.title + ": " + std::strerror(failed));
  }

  void follow(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      int status = 0;
      const bool ended = reaped(status);  // before the last look
      if (look() | ended) {
        if (ended) {
          const std::scoped_lock lock(mutex_);
          status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
          question_ = nullptr;
        }
        changed_();
      }
      if (ended) std::filesystem::remove(process_file_);
      if (ended) return;
      std::this_thread::sleep_for(kBetweenLooks);
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
    if (said.contains("note") && said["note"].is_string()) add_line(said["note"].get<std::string>());
    if (!said.contains("done") || !said.contains("total")) return;
    done_ = said.value("done", 0), total_ = said.value("total", 0);
    label_ = said.value("label", "");
    seconds_left_ = said.value("seconds_left", -1.0);
  }

  const std::string title_;
  const std::function<void()> changed_;
  pid_t process_ = -1;
  int input_ = -1;
  Growing output_, progress_;  // the follower's
  const std::filesystem::path process_file_;

  mutable std::mutex mutex_;
  std::optional<int> status_;
  bool gone_ = false;  // its number may be another process's by now
  int done_ = 0, total_ = 0;
  double seconds_left_ = -1;
  std::string label_;
  std::vector<std::string> lines_;
  nlohmann::json question_;  // null: none is open
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

void Job::pause() {
  process_->signal(1);
}

void Job::stop_now() {
  process_->signal(2);
}

}  // namespace station
