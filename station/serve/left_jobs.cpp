#include "station/serve/left_jobs.h"

#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace station {
namespace {

// When a process began, in the kernel's ticks since its start; 0 when there is none, or when it has ended
// and nobody has asked how.
unsigned long long began(pid_t process) {
  constexpr int kFieldsBetween = 18;  // from the state, which follows the name in brackets, to the beginning
  std::ifstream stream("/proc/" + std::to_string(process) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(text.substr(name_end + 1));
  std::string state, skipped;
  fields >> state;
  for (int i = 0; i < kFieldsBetween; ++i) fields >> skipped;
  unsigned long long ticks = 0;
  fields >> ticks;
  return state == "Z" ? 0 : ticks;
}

}  // namespace

void note_process(const std::filesystem::path& file, pid_t process) {
  std::ofstream(file) << process << " " << began(process) << "\n";
}

bool stop_left_jobs(const std::filesystem::path& folder, const std::filesystem::path& own) {
  constexpr auto kBetweenSignals = std::chrono::milliseconds(20);
  std::vector<pid_t> left;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != kProcessFile || entry.path() == own) continue;
    pid_t process = 0;
    unsigned long long begin = 0;
    std::ifstream(entry.path()) >> process >> begin;
    if (process > 0 && begin > 0 && began(process) == begin)
      left.push_back(process);
    else
      std::filesystem::remove(entry.path(), error);
  }
  for (const pid_t process : left) kill(process, SIGINT);
  if (!left.empty()) std::this_thread::sleep_for(kBetweenSignals);
  for (const pid_t process : left) kill(process, SIGINT);
  return !left.empty();
}

void forget_old_jobs(const std::filesystem::path& folder, std::size_t kept) {
  std::error_code error;
  std::map<std::string, std::vector<std::filesystem::path>, std::greater<>> jobs;  // the newest first
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    jobs[entry.path().stem().string()].push_back(entry.path());
  std::size_t checks = 0, others = 0;
  for (const auto& [name, files] : jobs) {
    if ((name.ends_with("-check") ? checks : others)++ < kept) continue;
    for (const std::filesystem::path& file : files)
      if (file.extension() != kProcessFile) std::filesystem::remove(file, error);
  }
}

}  // namespace station
