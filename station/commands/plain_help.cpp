#include "station/commands/plain_help.h"

#include <regex>
#include <sstream>

namespace station {
namespace {

std::string joined(const std::set<CLI::Option*>& options) {
  std::string names;
  for (const CLI::Option* option : options) names += (names.empty() ? "" : ", ") + typed_name(*option);
  return names;
}

}  // namespace

bool is_listed(const CLI::App* command) {
  return !command->get_group().empty();
}

std::vector<std::string> words_of(const CLI::Option& option) {
  // CLI11 lists them as {a,b}, and where they stand for values as {a->0,b->1} OR {0,1}.
  static const std::regex kList(R"(\{([^}]*)\})");
  const std::string type = option.get_type_name();
  std::vector<std::string> words;
  std::smatch list;
  if (!std::regex_search(type, list, kList)) return words;
  std::istringstream entries(list[1]);
  for (std::string entry; std::getline(entries, entry, ',');) words.push_back(entry.substr(0, entry.find("->")));
  return words;
}

std::string typed_name(const CLI::Option& option) {
  return option.get_name(option.get_positional(), false);
}

std::string value_of(const CLI::Option& option) {
  std::string words;
  for (const std::string& word : words_of(option)) words += (words.empty() ? "" : "|") + word;
  if (!words.empty()) return words;
  static const std::regex kRange(R"(\[(\S+) - (\S+)\])");
  const std::string type = option.get_type_name();
  std::smatch range;
  const std::string kind = type.starts_with("TEXT") ? "TEXT" : "NUMBER";
  if (!std::regex_search(type, range, kRange)) return kind;
  return kind + " (" + range[1].str() + " to " + range[2].str() + ")";
}

std::string PlainHelp::make_option_name(const CLI::Option* option, bool is_positional) const {
  const std::string name = option->get_name(is_positional, !is_positional);
  return name.substr(0, name.find('{'));  // CLI11 adds the value that a flag stands for
}

std::string PlainHelp::make_option_opts(const CLI::Option* option) const {
  std::string text;
  if (!option->get_type_name().empty()) {  // else a flag
    text += " " + value_of(*option);
    if (!option->get_default_str().empty()) text += " = " + option->get_default_str();
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
    if (option->get_required()) text += " (needed)";
  }
  if (!option->get_needs().empty()) text += " (with " + joined(option->get_needs()) + ")";
  if (!option->get_excludes().empty()) text += " (not with " + joined(option->get_excludes()) + ")";
  return text;
}

}  // namespace station
