// JSON files that people edit: every key with a comment that says what it means.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace station {

// What the keys of a kind of document mean, by their paths ("camera_by_tape.aim_mm").
using KeyMeanings = std::map<std::string, std::string>;

// The table "| key | meaning |" of a README. Its first column names keys in backticks; `...name` is a key of the last
// one that is given in full, and further names of a row lie where its first one does. Errors: those of reading a file;
// std::runtime_error when it has no such table.
KeyMeanings read_key_meanings(const std::filesystem::path& readme);

// The document with a comment above each key that has a meaning; it ends with a newline.
std::string commented_json(const nlohmann::ordered_json& document, const KeyMeanings& meanings);

}  // namespace station
