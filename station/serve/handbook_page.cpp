#include "station/serve/handbook_page.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "station/data/data_folder.h"
#include "station/documents/disk/whole_file.h"
#include "station/serve/page_answers.h"

namespace station {
namespace {

const std::map<std::string, std::string> kTypes{{".html", "text/html; charset=utf-8"},
                                                {".css", "text/css; charset=utf-8"},
                                                {".svg", "image/svg+xml"},
                                                {".jpg", "image/jpeg"}};

// Small letters, digits and _ in every part, one folder deep at most.
bool is_plain(const std::string& path) {
  const bool letters = std::ranges::all_of(path, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '/';
  });
  return letters && path.find("..") == std::string::npos && std::ranges::count(path, '/') <= 1 &&
         !path.starts_with("/") && !path.starts_with(".");
}

}  // namespace

HttpResponse handbook_page(const std::string& path) {
  const auto type = kTypes.find(std::filesystem::path(path).extension().string());
  const std::filesystem::path file = data_folder() / "handbook" / path;
  if (!is_plain(path) || type == kTypes.end() || !std::filesystem::is_regular_file(file))
    throw Refused(404, "the handbook has no such page; its first one is " + std::string(kHandbook) + "index.html");
  return {.content_type = type->second,
          .body = text_of_file(file),
          .headers = {{"Content-Security-Policy",
                       "default-src 'none'; img-src 'self'; style-src 'self'; frame-ancestors 'none'"}}};
}

}  // namespace station
