// The lines of a CSV file that hold something, without blanks around them and without the mark that spreadsheets write
// before the first one.
//
// Errors: those of disk/whole_file.h.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace station {

struct TableLine {
  std::size_t number = 0;  // in the file, from 1
  std::string text;
};

std::vector<TableLine> table_lines(const std::filesystem::path& file);

}  // namespace station
