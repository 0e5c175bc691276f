#include "tests/station/commands/program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/places.h"

namespace station_test {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// Where the programs of this test keep what they remember: not where this computer's user keeps it.
const fs::path& state_folder() {
  static const TemporaryFolder folder;
  return folder.path();
}

// Replaces the child's image; never returns.
[[noreturn]] void execute(const std::vector<std::string>& command, const char* out, const char* error,
                          const char* in = "/dev/null") {
  const int out_fd = ::open(out, O_WRONLY | O_CREAT | O_TRUNC, 0600),
            error_fd = ::open(error, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int in_fd = ::open(in, O_RDONLY);
  ::dup2(in_fd, 0);
  ::dup2(out_fd, 1);
  ::dup2(error_fd, 2);
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  ::execvp(words[0], words.data());
  ::_exit(127);
}

ProgramResult run(const std::vector<std::string>& command) {
  const TemporaryFolder folder;
  const std::string out = folder / "out", error = folder / "error", state = state_folder();
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) ::setenv("XDG_STATE_HOME", state.c_str(), 1);
  if (child == 0) execute(command, out.c_str(), error.c_str());
  ProgramResult result;
  result.status = wait_for(child);
  result.out = content(out);
  result.error = content(error);
  return result;
}

std::vector<std::string> with_program(const std::vector<std::string>& arguments) {
  std::vector<std::string> command{THREADSTATION_PROGRAM};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

}  // namespace

int ProgramResult::error_lines() const {
  int lines = 0;
  std::istringstream text(error);
  for (std::string line; std::getline(text, line);) lines += !line.starts_with("{\"done\":");
  return lines;
}

ProgramResult run_threadstation(const std::vector<std::string>& arguments) {
  return run(with_program(arguments));
}

ProgramResult run_shell(const std::string& command_line) {
  return run({"sh", "-c", command_line});
}

pid_t start_threadstation(const std::vector<std::string>& arguments, const fs::path& input,
                          const std::map<std::string, std::string>& environment, const fs::path& errors) {
  const std::vector<std::string> command = with_program(arguments);
  const std::string state = state_folder();
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child > 0) return child;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  ::setenv("XDG_STATE_HOME", state.c_str(), 1);
  for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
  execute(command, "/dev/null", errors.c_str(), input.c_str());
}

int wait_for(pid_t process) {
  int status = 0;
  ::waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "threadstation-test-XXXXXX").string();
  if (!::mkdtemp(name.data()))
    throw std::runtime_error("cannot make a folder for a test in " + fs::temp_directory_path().string());
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace station_test
