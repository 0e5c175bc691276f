// Runs of the threadstation program as a person would do them, with what it said.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace station_test {

struct ProgramResult {
  int status = 0;          // exit status; 128 + signal when it was killed
  std::string out, error;  // standard output and standard error
  // Of `error`, without the progress of --json, of which a busy computer says more.
  int error_lines() const;
};

// Runs the program; `arguments` come after its name.
ProgramResult run_threadstation(const std::vector<std::string>& arguments);
// Runs any command line through the shell.
ProgramResult run_shell(const std::string& command_line);

// Starts the program in the background, its output thrown away and its errors written to a file. `environment` is added
// to the test's own; ctrl-C and the like mean what they mean to a program in a terminal.
pid_t start_threadstation(const std::vector<std::string>& arguments, const std::filesystem::path& input = "/dev/null",
                          const std::map<std::string, std::string>& environment = {},
                          const std::filesystem::path& errors = "/dev/null");
int wait_for(pid_t process);  // exit status; 128 + signal when it was killed

// A new empty folder for one test, below the system's folder for temporary files; removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace station_test
