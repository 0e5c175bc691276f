// A CSV file of texts, as spreadsheets and barcode scanners write it: one line of column names, then rows. Read is
// UTF-8 with or without a byte order mark, with lines that end in LF or CR LF and cells in double quotes where they
// hold commas.
//
// Errors: std::runtime_error, one line: the file, the line, what was found and what to do. Refused are files that
// cannot be read or have no rows, columns that are unknown, missing or named twice, rows with more or fewer cells than
// columns, semicolons or tabs instead of commas, quotes that do not end, and bytes that are no UTF-8.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace station {

struct TextRow {
  std::size_t line = 0;                      // number of the row's line in the file
  std::map<std::string, std::string> cells;  // by column; a column that the file does not have is empty

  const std::string& operator[](const std::string& column) const { return cells.at(column); }
};

std::vector<TextRow> read_text_table(const std::filesystem::path& file, const std::vector<std::string>& required,
                                     const std::vector<std::string>& optional);

}  // namespace station
