// A CSV file as texts, the way that spreadsheets and barcode scanners write it: one line of column names, then rows.
// Read is UTF-8 with or without a byte order mark, with lines that end in LF or CR LF and cells in double quotes where
// they hold commas; blanks around cells and lines without anything are passed over.
//
// Errors: std::runtime_error, one line: the file, the line, what was found and what to do. Refused are files that
// cannot be read or have no rows, columns that are unknown, missing or named twice, rows with more or fewer cells than
// columns, semicolons or tabs instead of commas, quotes that do not end, and bytes that are no UTF-8.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace station {

struct TextTable {
  struct Row {
    std::size_t line = 0;            // number of the row's line in the file
    std::vector<std::string> cells;  // one for each column
  };
  std::vector<std::string> columns;  // as the file names them
  std::vector<Row> rows;
  std::map<std::string, std::string> notes{};  // value by name

  // The place of a column; nothing when the file does not have it.
  std::optional<std::size_t> index_of(const std::string& column) const;
  // The cell of a row; empty in a column that the file does not have.
  std::string cell(const Row& row, const std::string& column) const;
};

// With `notes`, lines that start with # are comments, and "# name value" is a note about the whole table.
TextTable read_text_table(const std::filesystem::path& file, const std::vector<std::string>& required,
                          const std::vector<std::string>& optional, bool notes = false);

}  // namespace station
