#include "station/commands/ready_name.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "station/commands/nearest_word.h"
#include "station/data/data_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;

// The ready files by their names. Threads of the library go before examples of the same name.
std::map<std::string, fs::path> files_in(const std::string& folder) {
  std::map<std::string, fs::path> files;
  for (const fs::path& place : {data_folder() / "library" / folder, data_folder() / folder}) {
    if (!fs::is_directory(place)) continue;
    for (const auto& entry : fs::directory_iterator(place))
      if (entry.path().extension() == ".json") files.emplace(entry.path().stem(), entry.path());
  }
  return files;
}

std::string refused(const std::string& name, const std::string& folder, const std::map<std::string, fs::path>& files) {
  std::set<std::string> ready;
  for (const auto& [one, file] : files) ready.insert(one);
  const std::string kind = folder.substr(0, folder.size() - 1);  // "draft" of "drafts"
  std::string text = "there is no file " + name + " and no ready " + kind + " of that name";
  if (const auto nearest = nearest_word(name, {ready.begin(), ready.end()}))
    return text + "; did you mean " + *nearest + "?";
  for (const std::string& one : ready) text += (one == *ready.begin() ? "; ready ones: " : ", ") + one;
  return text;
}

}  // namespace

CLI::Option* or_ready(const std::string& folder, CLI::Option* option) {
  return option->transform(CLI::Validator(
      [folder](std::string& value) -> std::string {
        if (value.empty() || value.find_first_of("/.") != value.npos || fs::exists(value)) return "";
        const std::map<std::string, fs::path> ready = files_in(folder);
        if (!ready.contains(value)) return refused(value, folder, ready);
        value = ready.at(value);
        return "";
      },
      ""));
}

}  // namespace station
