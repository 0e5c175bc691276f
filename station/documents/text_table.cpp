#include "station/documents/text_table.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "station/documents/disk/whole_file.h"
#include "station/documents/text_pieces.h"

namespace station {
namespace {

using Cells = std::vector<std::string>;

[[noreturn]] void refuse(const std::filesystem::path& file, std::size_t line, const std::string& problem) {
  throw std::runtime_error(file.string() + (line > 0 ? " line " + std::to_string(line) : "") + ": " + problem);
}

bool is_utf8(const std::string& text) {
  try {
    [[maybe_unused]] const std::string dumped = nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

// The cells of a line; nothing when a quote does not end.
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
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

std::string known(const Cells& required, const Cells& optional) {
  return joined(required) + (required.empty() || optional.empty() ? "" : ", ") + joined(optional);
}

void check_columns(const std::filesystem::path& file, std::size_t line, const Cells& names, const Cells& required,
                   const Cells& optional) {
  if (names.size() == 1 && names.front().find_first_of(";\t") != std::string::npos)
    refuse(file, line, "columns are separated by semicolons or tabs; save the table with commas (CSV)");
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) > 1)
      refuse(file, line, "the column \"" + name + "\" stands there twice; remove one");
    if (std::ranges::find(required, name) == required.end() && std::ranges::find(optional, name) == optional.end())
      refuse(file, line, "the column \"" + name + "\" is not known; known are " + known(required, optional));
  }
  for (const std::string& name : required)
    if (std::ranges::find(names, name) == names.end())
      refuse(file, line, "the column \"" + name + "\" is missing; add it to the first line");
}

// The cells of a line; refuses one that is no text or whose quotes do not end.
Cells cells_of(const std::filesystem::path& file, std::size_t number, const std::string& line) {
  if (!is_utf8(line) || line.find('\0') != std::string::npos)
    refuse(file, number, "holds bytes that are no UTF-8 text; save the table as UTF-8");
  const std::optional<Cells> cells = split(line);
  if (!cells) refuse(file, number, "a quote does not end on its line; close it");
  return *cells;
}

}  // namespace

std::optional<std::size_t> TextTable::index_of(const std::string& column) const {
  const auto at = std::ranges::find(columns, column);
  if (at == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(at - columns.begin());
}

std::string TextTable::cell(const Row& row, const std::string& column) const {
  const std::optional<std::size_t> index = index_of(column);
  return index ? row.cells[*index] : "";
}

TextTable read_text_table(const std::filesystem::path& file, const Cells& required, const Cells& optional, bool notes) {
  TextTable table;
  std::istringstream in(text_of_file(file));
  std::size_t number = 0;
  for (std::string whole; std::getline(in, whole);) {
    if (++number == 1 && whole.starts_with("\xEF\xBB\xBF")) whole.erase(0, 3);
    const std::string line = trimmed(whole);
    if (line.empty()) continue;
    if (notes && line.front() == '#') {
      const std::string comment = trimmed(line.substr(1));
      const std::size_t space = comment.find(' ');
      if (space != std::string::npos) table.notes[comment.substr(0, space)] = trimmed(comment.substr(space));
      continue;
    }
    const Cells cells = cells_of(file, number, line);
    if (table.columns.empty()) {
      check_columns(file, number, cells, required, optional);
      table.columns = cells;
      continue;
    }
    if (cells.size() != table.columns.size())
      refuse(file, number,
             std::to_string(cells.size()) + " cells found, the first line names " +
                 std::to_string(table.columns.size()) + " columns; put texts with commas into double quotes");
    table.rows.push_back({number, cells});
  }
  if (table.columns.empty())
    refuse(file, 0, "is empty; its first line must name columns of " + known(required, optional));
  if (table.rows.empty()) refuse(file, 0, "has no rows below its column names; add some");
  return table;
}

}  // namespace station
