// What a person may have meant who typed a command or an option that there is not.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace station {

// How many letters must be typed, left out, changed or exchanged with their neighbour to make `a` of `b`.
int typing_distance(const std::string& a, const std::string& b);

// The one of the known words that a person may have meant; nothing when none is near.
std::optional<std::string> nearest_word(const std::string& word, const std::vector<std::string>& known);

// One line about the first of the words after the program's name that is neither a command where one must stand nor an
// option of the command before it; nothing when there is none.
std::optional<std::string> unknown_word(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace station
