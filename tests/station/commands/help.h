// What --help says of the program's commands.
#pragma once

#include <string>
#include <vector>

namespace station_test {

using Words = std::vector<std::string>;

// Of the program (no words) or of one of its commands ("scatter", "eval").
std::string help_of(Words command);
// The commands that it lists, with the heading that each stands under.
struct ListedCommand {
  std::string name, heading;
};
std::vector<ListedCommand> listed_below(const Words& command);
// Every command, those with commands of their own before these.
std::vector<Words> every_command();
// The line that --help gives as an example; "" where it has none.
std::string example_of(const Words& command);

std::string joined(const Words& words);

}  // namespace station_test
