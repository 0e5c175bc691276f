#include "station/documents/table_lines.h"

#include <sstream>

#include "station/documents/disk/whole_file.h"
#include "station/documents/text_pieces.h"

namespace station {

std::vector<TableLine> table_lines(const std::filesystem::path& file) {
  std::istringstream in(text_of_file(file));
  std::vector<TableLine> lines;
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    if (++number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (std::string text = trimmed(line); !text.empty()) lines.push_back({number, std::move(text)});
  }
  return lines;
}

}  // namespace station
