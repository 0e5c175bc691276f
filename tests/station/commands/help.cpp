#include "tests/station/commands/help.h"

#include <map>
#include <set>
#include <sstream>

#include "tests/station/commands/program.h"

namespace station_test {
namespace {

void add_below(const Words& command, std::vector<Words>& found) {
  for (const ListedCommand& below : listed_below(command)) {
    Words deeper = command;
    deeper.push_back(below.name);
    found.push_back(deeper);
    add_below(deeper, found);
  }
}

}  // namespace

std::string help_of(Words command) {
  static std::map<Words, std::string> known;  // each start of the program takes a while
  const auto found = known.find(command);
  if (found != known.end()) return found->second;
  const Words asked = command;
  command.emplace_back("--help");
  return known[asked] = run_threadstation(command).out;
}

std::vector<ListedCommand> listed_below(const Words& command) {
  static const std::set<std::string> kOthers{"Usage", "Options", "Positionals", "Example"};
  std::vector<ListedCommand> listed;
  std::istringstream lines(help_of(command));
  std::string heading;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.front() != ' ')
      heading = line.find(':') == std::string::npos ? "" : line.substr(0, line.find(':'));
    std::istringstream words(line);
    std::string name;
    if (!heading.empty() && !kOthers.contains(heading) && line.starts_with("  ") && !line.starts_with("   ") &&
        words >> name)
      listed.push_back({name, heading});
  }
  return listed;
}

std::vector<Words> every_command() {
  std::vector<Words> found;
  add_below({}, found);
  return found;
}

std::string example_of(const Words& command) {
  const std::string help = help_of(command), heading = "\nExample:\n  ";
  const std::size_t at = help.find(heading);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + heading.size();
  return help.substr(begin, help.find('\n', begin) - begin);
}

std::string joined(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

}  // namespace station_test
