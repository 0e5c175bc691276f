// The page's own files (page/), part of the program.
#pragma once

#include <string>
#include <string_view>

namespace station {

struct PageFile {
  std::string_view path;  // of the address
  const char* content_type;
  std::string_view content;
};

// The file of the page at this path; null when there is none.
const PageFile* page_file(std::string_view path);

}  // namespace station
