#include "station/documents/text_table.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

namespace station {
namespace {

using Cells = std::vector<std::string>;

[[noreturn]] void refuse(const std::filesystem::path& file, std::size_t line, const std::string& problem) {
  throw std::runtime_error(file.string() + (line > 0 ? " line " + std::to_string(line) : "") + ": " + problem);
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

bool is_utf8(const std::string& text) {
  try {
    [[maybe_unused]] const std::string dumped = nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

// Nothing when a quote does not end.
std::optional<Cells> split(const std::string& line) {
  Cells cells(1);
  bool quoted = false, was_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += '"';
      ++i;
    } else if (quoted && c == '"') {
      quoted = false;
    } else if (!quoted && c == '"' && trimmed(cells.back()).empty() && !was_quoted) {
      cells.back().clear();
      quoted = was_quoted = true;
    } else if (!quoted && c == ',') {
      cells.emplace_back();
      was_quoted = false;
    } else {
      cells.back() += c;
    }
  }
  if (quoted) return std::nullopt;
  std::transform(cells.begin(), cells.end(), cells.begin(), trimmed);
  return cells;
}

std::string joined(const Cells& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

void check_columns(const std::filesystem::path& file, std::size_t line, const Cells& names, const Cells& required,
                   const Cells& optional) {
  if (names.size() == 1 && names.front().find_first_of(";\t") != std::string::npos)
    refuse(file, line, "columns are separated by semicolons or tabs; save the table with commas (CSV)");
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) > 1)
      refuse(file, line, "the column \"" + name + "\" stands there twice; remove one");
    if (std::ranges::find(required, name) == required.end() && std::ranges::find(optional, name) == optional.end())
      refuse(file, line,
             "the column \"" + name + "\" is not known; known are " + joined(required) +
                 (required.empty() || optional.empty() ? "" : ", ") + joined(optional));
  }
  for (const std::string& name : required)
    if (std::ranges::find(names, name) == names.end())
      refuse(file, line, "the column \"" + name + "\" is missing; add it to the first line");
}

}  // namespace

std::vector<TextRow> read_text_table(const std::filesystem::path& file, const Cells& required,
                                     const Cells& optional) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file))
    refuse(file, 0,
           std::filesystem::exists(file) ? "is not a readable file; check the path" : "no such file; check the path");
  Cells names;
  std::vector<TextRow> rows;
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (line.ends_with('\r')) line.pop_back();
    if (trimmed(line).empty()) continue;
    if (!is_utf8(line) || line.find('\0') != std::string::npos)
      refuse(file, number, "holds bytes that are no UTF-8 text; save the table as UTF-8");
    const std::optional<Cells> cells = split(line);
    if (!cells) refuse(file, number, "a quote does not end on its line; close it");
    if (names.empty()) {
      names = *cells;
      check_columns(file, number, names, required, optional);
      continue;
    }
    if (cells->size() != names.size())
      refuse(file, number,
             std::to_string(cells->size()) + " cells found, the first line names " + std::to_string(names.size()) +
                 " columns; put texts with commas into double quotes");
    TextRow row{.line = number, .cells = {}};
    for (const Cells& known : {required, optional})
      for (const std::string& name : known) row.cells[name];
    for (std::size_t i = 0; i < names.size(); ++i) row.cells[names[i]] = (*cells)[i];
    rows.push_back(std::move(row));
  }
  if (rows.empty()) refuse(file, 0, "has no rows below its column names; add some");
  return rows;
}

}  // namespace station
