#include "station/batch/slurm.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "station/output/child_process.h"

namespace station {
namespace {

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::string said_by(const std::vector<std::string>& words, const std::string& input = {}) {
  const CommandResult result = run_command(words, input);
  if (result.status == 0) return result.out;
  throw std::runtime_error(
      words.front() + " refused: " + first_line(result.error.empty() ? result.out : result.error) +
      "; put the plan's \"slurm\" options right, or run the same command when Slurm has less to do");
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, '|');) cells.push_back(cell);
  return cells;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

}  // namespace

int slurm_array_size() {
  constexpr int kUsual = 1001;
  std::istringstream lines(said_by({"scontrol", "show", "config"}));
  std::string key, equals;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    int size = 0;
    if (!(words >> key >> equals >> size) || key != "MaxArraySize") continue;
    if (size < 1) throw std::runtime_error("this Slurm takes no arrays of jobs (MaxArraySize is 0); ask who runs it");
    return size;
  }
  return kUsual;
}

std::string slurm_submit(const std::vector<std::string>& options, const std::string& script) {
  std::vector<std::string> words{"sbatch", "--parsable"};
  words.insert(words.end(), options.begin(), options.end());
  const std::string said = first_line(said_by(words, script));
  return said.substr(0, said.find(';'));  // "number;cluster"
}

std::vector<SlurmTask> slurm_queue() {
  std::vector<SlurmTask> tasks;
  std::istringstream lines(said_by({"squeue", "--me", "--noheader", "--array", "--format=%F|%j|%K|%T|%r"}));
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() < 5 || cells[2].find_first_not_of("0123456789") != std::string::npos) continue;  // no array's
    tasks.push_back({cells[0], cells[1], std::stoi(cells[2]), cells[3], cells[4]});
  }
  return tasks;
}

std::optional<std::map<std::string, std::string>> slurm_ended(const std::vector<std::string>& jobs) {
  std::map<std::string, std::string> states;
  if (jobs.empty()) return states;
  const std::string of = "--jobs=" + joined(jobs);
  // From the accounts or, where there are none, from the list of completed jobs.
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"sacct", "--allocations", "--format=JobIDRaw,State"},
        {"sacct", "--completion", "--format=JobID,State"}}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--noheader", "--parsable2", of});
    const CommandResult result = run_command(all);
    if (result.status != 0) continue;
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);)
      if (const std::vector<std::string> cells = cells_of(line); cells.size() == 2) states[cells[0]] = cells[1];
    return states;
  }
  return std::nullopt;
}

void slurm_cancel(const std::vector<std::string>& jobs) {
  if (jobs.empty()) return;
  std::vector<std::string> words{"scancel"};
  words.insert(words.end(), jobs.begin(), jobs.end());
  said_by(words);
}

std::string ranges_text(std::vector<int> numbers) {
  std::ranges::sort(numbers);
  std::string text;
  for (std::size_t i = 0, last = 0; i < numbers.size(); i = last + 1) {
    for (last = i; last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1;) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(numbers[i]);
    if (last > i) text += "-" + std::to_string(numbers[last]);
  }
  return text;
}

}  // namespace station
