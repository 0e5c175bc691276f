// What files held at a moment, and whether they still do, without reading those that nobody touched.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace station {

struct FileStamp {
  std::string sha256;
  std::uintmax_t bytes = 0;
  std::int64_t modified_ns = 0;  // of the file system's clock
};
using FileStamps = std::map<std::string, FileStamp>;  // by absolute path

// The files as they are. Those that have the size and time of `known` are not read again. Errors: std::runtime_error,
// one line, for one that cannot be read.
FileStamps stamps_of(const std::vector<std::filesystem::path>& files, const FileStamps& known = {});
// Whether both have the same files with the same content.
bool same_content(const FileStamps& a, const FileStamps& b);

nlohmann::json to_json(const FileStamps& stamps);
FileStamps parse_stamps(const nlohmann::json& document);

}  // namespace station
