// What --help says of options, in words for people.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace station {

// Whether --help lists a command.
bool is_listed(const CLI::App* command);

// The words that an option takes, in their order; empty when it takes more than a few.
std::vector<std::string> words_of(const CLI::Option& option);

// The name of an option or argument that is typed: --out, scene.
std::string typed_name(const CLI::Option& option);

// One line for a value: its words (a4|letter), else TEXT or NUMBER with its range.
std::string value_of(const CLI::Option& option);

// CLI11's layout without its notes to programmers.
class PlainHelp : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
};

}  // namespace station
