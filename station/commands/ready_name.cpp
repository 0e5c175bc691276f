#include "station/commands/ready_name.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "station/commands/nearest_word.h"
#include "station/data/data_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json") names.insert(entry.path().stem());
  return names;
}

std::string refused(const std::string& name, const std::string& folder, const std::set<std::string>& ready) {
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
        const std::set<std::string> ready = names_in(data_folder() / folder);
        if (!ready.contains(value)) return refused(value, folder, ready);
        value = data_folder() / folder / (value + ".json");
        return "";
      },
      ""));
}

}  // namespace station
