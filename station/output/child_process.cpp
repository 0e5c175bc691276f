#include "station/output/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include "station/output/interrupt.h"

extern char** environ;

namespace station {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

int status_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// What a process begins with; freed with the object.
class Actions {
 public:
  Actions() { posix_spawn_file_actions_init(&actions_); }
  ~Actions() { posix_spawn_file_actions_destroy(&actions_); }
  Actions(const Actions&) = delete;
  Actions& operator=(const Actions&) = delete;
  posix_spawn_file_actions_t* operator&() { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

pid_t spawned(std::vector<std::string>& words, Actions& actions, int first_closed = STDERR_FILENO + 1) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_addclosefrom_np(&actions, first_closed);
  // Ctrl-C in a terminal is for the program that started it, which hands it on.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t process = -1;
  const int failed = posix_spawnp(&process, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0)
    throw std::runtime_error("cannot start " + words[0] + ": " + std::strerror(failed) +
                             (failed == ENOENT ? "; install it, or check the PATH" : ""));
  return process;
}

}  // namespace

std::filesystem::path own_program_file() {
  return std::filesystem::read_symlink(kOwnProgram);
}

ChildProcess::ChildProcess(std::vector<std::string> words, const std::filesystem::path& said,
                           const std::filesystem::path& folder, int held)
    : start_s_(now_s()) {
  constexpr int kHeld = STDERR_FILENO + 1;
  Actions actions;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, said.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  if (held >= 0) posix_spawn_file_actions_adddup2(&actions, held, kHeld);
  process_ = spawned(words, actions, held >= 0 ? kHeld + 1 : kHeld);
}

ChildProcess::~ChildProcess() {
  if (process_ < 0 || ended_) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)), start_s_(other.start_s_), ended_(other.ended_) {}

std::optional<EndedProcess> ChildProcess::ended() {
  if (ended_) return ended_;
  int status = 0;
  rusage usage{};
  if (wait4(process_, &status, WNOHANG, &usage) != process_) return std::nullopt;
  ended_ = {.status = status_of(status),
            .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
            .seconds = now_s() - start_s_,
            .processor_s = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime),
            .peak_mib = static_cast<double>(usage.ru_maxrss) / 1024};
  return ended_;
}

void ChildProcess::signal(int number) const {
  if (!ended_) kill(process_, number);
}

EndedProcess run_own_program(std::vector<std::string> arguments, const std::filesystem::path& said,
                             const std::filesystem::path& folder, int held) {
  constexpr auto kLooks = std::chrono::milliseconds(20);
  arguments.insert(arguments.begin(), kOwnProgram);
  ChildProcess process(std::move(arguments), said, folder, held);
  for (int told = 0;;) {
    if (const auto ended = process.ended()) return *ended;
    for (; told < interrupts(); ++told) process.signal(SIGINT);
    std::this_thread::sleep_for(kLooks);
  }
}

std::string last_words(const std::filesystem::path& said) {
  const std::string problem = "threadstation: ";
  std::string last, told;
  std::ifstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(problem)) told = line.substr(problem.size());
    if (!line.empty()) last = line;
  }
  return told.empty() ? last : told;
}

CommandResult run_command(std::vector<std::string> words, const std::string& input) {
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  const std::array<File, 3> files{File(std::tmpfile(), std::fclose), File(std::tmpfile(), std::fclose),
                                  File(std::tmpfile(), std::fclose)};
  for (const File& file : files)
    if (!file) throw std::runtime_error("cannot start " + words[0] + ": no room for temporary files; free space there");
  std::fwrite(input.data(), 1, input.size(), files[0].get());
  std::rewind(files[0].get());
  Actions actions;
  for (int i = 0; i < 3; ++i)
    posix_spawn_file_actions_adddup2(&actions, fileno(files.at(static_cast<std::size_t>(i)).get()), i);
  const pid_t process = spawned(words, actions);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  const auto content = [](std::FILE* file) {
    std::string text;
    std::array<char, 4096> block{};
    std::rewind(file);
    for (std::size_t read = 0; (read = std::fread(block.data(), 1, block.size(), file)) > 0;)
      text.append(block.data(), read);
    return text;
  };
  return {.status = status_of(status), .out = content(files[1].get()), .error = content(files[2].get())};
}

}  // namespace station
