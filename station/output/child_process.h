// Other programs that are started and waited for, and what they took.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace station {

struct EndedProcess {
  int status = 0;  // exit status; 128 + signal when it was killed
  int signal = 0;  // that killed it; 0: none
  double seconds = 0, processor_s = 0;
  double peak_mib = 0;  // of its memory
};

// This program, to be started again: as the system calls it, and its file.
inline constexpr const char* kOwnProgram = "/proc/self/exe";
std::filesystem::path own_program_file();

// A program with what it says, on both outputs, in a file; it reads nothing. Where this object goes away first, it is
// killed.
class ChildProcess {
 public:
  // `held`: a file that it keeps open to its end, such as a lock that is to last as long as it; -1: none. Errors:
  // std::runtime_error, one line, when it cannot be started.
  ChildProcess(std::vector<std::string> words, const std::filesystem::path& said, const std::filesystem::path& folder,
               int held = -1);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) = delete;

  std::optional<EndedProcess> ended();  // asked without waiting; once it has ended it stays so
  void signal(int number) const;        // to it alone; nothing when it has ended

 private:
  pid_t process_ = -1;
  double start_s_ = 0;
  std::optional<EndedProcess> ended_;
};

// Runs this program with these arguments to its end, as a ChildProcess; after ctrl-C (interrupt.h) it is asked to stop,
// as often as we are.
EndedProcess run_own_program(std::vector<std::string> arguments, const std::filesystem::path& said,
                             const std::filesystem::path& folder, int held = -1);
// The last line of what it has said that tells a problem, or its last line; empty when it said nothing.
std::string last_words(const std::filesystem::path& said);

struct CommandResult {
  int status = 0;
  std::string out, error;
};
// Runs a short command to its end, `input` on its standard input. Errors: std::runtime_error, one line, when there is
// no such program.
CommandResult run_command(std::vector<std::string> words, const std::string& input = {});

}  // namespace station
