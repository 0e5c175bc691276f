// A CSV file of numbers: a table as text_table.h reads it, with notes, whose cells are finite numbers.
//
// Errors: those of text_table.h; std::runtime_error, one line that names the file, line and column, what was found and
// what is expected, for whatever is not a finite number.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "station/documents/range.h"
#include "station/documents/text_table.h"

namespace station {

class NumberTable {
 public:
  NumberTable(const std::filesystem::path& file, const std::vector<std::string>& required,
              const std::vector<std::string>& optional);

  std::size_t rows() const { return table_.rows.size(); }
  bool has(const std::string& column) const { return table_.index_of(column).has_value(); }
  double number(std::size_t row, const std::string& column, Range range) const;  // refuses a value outside `range`
  double note(const std::string& name, Range range) const;  // refuses a missing note, no number, or one outside

 private:
  [[noreturn]] void refuse(const std::string& problem) const;
  [[noreturn]] void refuse(std::size_t line, std::size_t column, const std::string& problem) const;

  std::string file_;
  TextTable table_;
  std::vector<double> values_;  // row after row
};

}  // namespace station
