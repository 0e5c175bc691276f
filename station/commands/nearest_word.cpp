#include "station/commands/nearest_word.h"

#include <algorithm>

#include "station/commands/plain_help.h"

namespace station {
namespace {

constexpr int kNear = 2;  // further words have nothing to do with each other
using Words = std::vector<std::string>;

Words command_names_of(const CLI::App& app) {
  Words names;
  for (const CLI::App* command : app.get_subcommands(is_listed)) names.push_back(command->get_name());
  return names;
}

Words option_names_of(const CLI::App& app) {
  Words names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string said(const std::string& word, const Words& known, const CLI::App& app) {
  if (const auto nearest = nearest_word(word, known)) return word + ": did you mean " + *nearest + "?";
  std::string command = app.get_name();
  for (const CLI::App* above = app.get_parent(); above; above = above->get_parent())
    command = above->get_name() + " " + command;
  return word + " is not known here; " + command + " --help lists what is";
}

}  // namespace

int typing_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = static_cast<int>(i + j);
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

std::optional<std::string> nearest_word(const std::string& word, const Words& known) {
  const auto nearest =
      std::ranges::min_element(known, {}, [&](const std::string& k) { return typing_distance(word, k); });
  const int most = std::min<int>(kNear, static_cast<int>(word.size()) / 2);
  return nearest != known.end() && typing_distance(word, *nearest) <= most ? std::optional(*nearest) : std::nullopt;
}

std::optional<std::string> unknown_word(const CLI::App& app, const Words& words) {
  const CLI::App* at = &app;
  for (const std::string& word : words) {
    if (word == "--") break;
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      if (!at->get_option_no_throw(name)) return said(name, option_names_of(*at), *at);
      continue;
    }
    const auto found = at->get_subcommands([&](const CLI::App* command) { return command->get_name() == word; });
    if (!found.empty())
      at = found.front();
    else if (at->get_require_subcommand_min() > 0 && !word.starts_with("-"))
      return said(word, command_names_of(*at), *at);
  }
  return std::nullopt;
}

}  // namespace station
