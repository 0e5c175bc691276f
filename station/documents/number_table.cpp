#include "station/documents/number_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "station/documents/number_text.h"
#include "station/documents/table_lines.h"
#include "station/documents/text_pieces.h"

namespace station {
namespace {

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    found.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string::npos) return found;
    begin = comma + 1;
  }
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::optional<double> finite_number(const std::string& text) {
  double value = 0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string shown(Range range) {
  return "a number from " + shortest_text(range.low) + " to " + shortest_text(range.high);
}

}  // namespace

NumberTable::NumberTable(const std::filesystem::path& file, const std::vector<std::string>& required,
                         const std::vector<std::string>& optional)
    : file_(file.string()) {
  for (const auto& [number, line] : table_lines(file)) {
    if (line.front() == '#') {
      const std::string comment = trimmed(line.substr(1));
      const std::size_t space = comment.find(' ');
      if (space != std::string::npos) notes_[comment.substr(0, space)] = trimmed(comment.substr(space));
      continue;
    }
    if (names_.empty())
      read_names(line, required, optional);
    else
      read_row(line, number);
  }
  if (names_.empty()) refuse("is empty; the first line must name the columns " + joined(required));
  if (lines_.empty()) refuse("has no rows below its column names; add some");
}

void NumberTable::read_names(const std::string& line, const std::vector<std::string>& required,
                             const std::vector<std::string>& optional) {
  names_ = cells(line);
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const std::string& name = names_[i];
    if (!contains(required, name) && !contains(optional, name))
      refuse("unknown column \"" + name + "\"; expected " + joined(required) +
             (optional.empty() ? "" : " and, where wanted, " + joined(optional)));
    if (static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin()) != i)
      refuse("column \"" + name + "\" is there twice; keep one");
  }
  for (const std::string& name : required)
    if (!contains(names_, name)) refuse("column \"" + name + "\" is missing; expected " + joined(required));
}

void NumberTable::read_row(const std::string& text, std::size_t line) {
  const std::vector<std::string> row = cells(text);
  if (row.size() != names_.size())
    refuse("line " + std::to_string(line) + ": found " + std::to_string(row.size()) + " values, expected " +
           std::to_string(names_.size()) + ", one per column");
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::optional<double> value = finite_number(row[i]);
    if (!value) refuse(line, i, "found \"" + row[i].substr(0, 40) + "\", expected a finite number");
    values_.push_back(*value);
  }
  lines_.push_back(line);
}

double NumberTable::number(std::size_t row, const std::string& column, Range range) const {
  const std::size_t index = index_of(column).value();
  const double value = values_[row * names_.size() + index];
  if (!(value >= range.low && value <= range.high))
    refuse(lines_[row], index, "found " + shortest_text(value) + ", expected " + shown(range));
  return value;
}

double NumberTable::note(const std::string& name, Range range) const {
  const auto at = notes_.find(name);
  if (at == notes_.end()) refuse("no line \"# " + name + " ...\"; expected " + shown(range));
  const std::optional<double> value = finite_number(at->second);
  if (!value || !(*value >= range.low && *value <= range.high))
    refuse("\"# " + name + "\": found \"" + at->second.substr(0, 40) + "\", expected " + shown(range));
  return *value;
}

std::optional<std::size_t> NumberTable::index_of(const std::string& column) const {
  const auto at = std::find(names_.begin(), names_.end(), column);
  if (at == names_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - names_.begin());
}

void NumberTable::refuse(const std::string& problem) const {
  throw std::runtime_error(file_ + ": " + problem);
}

void NumberTable::refuse(std::size_t line, std::size_t column, const std::string& problem) const {
  refuse("line " + std::to_string(line) + ", column \"" + names_[column] + "\": " + problem);
}

}  // namespace station
