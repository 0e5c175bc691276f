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

// None for an address that is none of them.
const PageFile* page_file(std::string_view path);

}  // namespace station
