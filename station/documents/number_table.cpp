#include "station/documents/number_table.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "station/documents/disk/shown_text.h"
#include "station/documents/number_text.h"

namespace station {
namespace {

std::string shown(Range range) {
  return "a number from " + shortest_text(range.low) + " to " + shortest_text(range.high);
}

}  // namespace

NumberTable::NumberTable(const std::filesystem::path& file, const std::vector<std::string>& required,
                         const std::vector<std::string>& optional)
    : file_(file.string()), table_(read_text_table(file, required, optional, true)) {
  for (const TextTable::Row& row : table_.rows)
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const std::optional<double> value = finite_number(row.cells[i]);
      if (!value) refuse(row.line, i, "found \"" + shown_text(row.cells[i]) + "\", expected a finite number");
      values_.push_back(*value);
    }
}

double NumberTable::number(std::size_t row, const std::string& column, Range range) const {
  const std::size_t index = table_.index_of(column).value();
  const double value = values_[row * table_.columns.size() + index];
  if (!(value >= range.low && value <= range.high))
    refuse(table_.rows[row].line, index, "found " + shortest_text(value) + ", expected " + shown(range));
  return value;
}

double NumberTable::note(const std::string& name, Range range) const {
  const auto at = table_.notes.find(name);
  if (at == table_.notes.end()) refuse("no line \"# " + name + " ...\"; expected " + shown(range));
  const std::optional<double> value = finite_number(at->second);
  if (!value || !(*value >= range.low && *value <= range.high))
    refuse("\"# " + name + "\": found \"" + shown_text(at->second) + "\", expected " + shown(range));
  return *value;
}

void NumberTable::refuse(const std::string& problem) const {
  throw std::runtime_error(file_ + ": " + problem);
}

void NumberTable::refuse(std::size_t line, std::size_t column, const std::string& problem) const {
  refuse("line " + std::to_string(line) + ", column \"" + table_.columns[column] + "\": " + problem);
}

}  // namespace station
