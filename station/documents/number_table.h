// A CSV file of numbers, read strictly: one line of column names, then rows. Lines that start with # are comments; one
// of the form "# name value" is a note about the whole table.
//
// Errors: std::runtime_error, one line: the file, the line and column where there is one, what was found and what is
// expected. Refused are files that cannot be read or have no rows, columns that are missing, unknown or named twice,
// rows with more or fewer values than columns, and whatever is not a finite number.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "station/documents/range.h"

namespace station {

class NumberTable {
 public:
  NumberTable(const std::filesystem::path& file, const std::vector<std::string>& required,
              const std::vector<std::string>& optional);

  std::size_t rows() const { return lines_.size(); }
  bool has(const std::string& column) const { return index_of(column).has_value(); }
  double number(std::size_t row, const std::string& column, Range range) const;  // refuses a value outside `range`
  double note(const std::string& name, Range range) const;  // refuses a missing note, no number, or one outside

 private:
  void read_names(const std::string& line, const std::vector<std::string>& required,
                  const std::vector<std::string>& optional);
  void read_row(const std::string& text, std::size_t line);
  std::optional<std::size_t> index_of(const std::string& column) const;
  [[noreturn]] void refuse(const std::string& problem) const;
  [[noreturn]] void refuse(std::size_t line, std::size_t column, const std::string& problem) const;

  std::string file_;
  std::vector<std::string> names_;
  std::vector<double> values_;      // row after row
  std::vector<std::size_t> lines_;  // line in the file, by row
  std::map<std::string, std::string> notes_;
};

}  // namespace station
