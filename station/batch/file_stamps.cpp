#include "station/batch/file_stamps.h"

#include <algorithm>
#include <chrono>

#include "station/documents/disk/sha256.h"

namespace station {
namespace fs = std::filesystem;

FileStamps stamps_of(const std::vector<fs::path>& files, const FileStamps& known) {
  FileStamps stamps;
  for (const fs::path& file : files) {
    FileStamp stamp;
    std::error_code problem;
    stamp.bytes = fs::file_size(file, problem);
    const auto modified = fs::last_write_time(file, problem).time_since_epoch();
    stamp.modified_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(modified).count();
    const auto before = known.find(file.string());
    const bool untouched = !problem && before != known.end() && before->second.bytes == stamp.bytes &&
                           before->second.modified_ns == stamp.modified_ns;
    stamp.sha256 = untouched ? before->second.sha256 : sha256_of_file(file);
    stamps[file.string()] = stamp;
  }
  return stamps;
}

bool same_content(const FileStamps& a, const FileStamps& b) {
  return std::ranges::equal(a, b, [](const auto& one, const auto& other) {
    return one.first == other.first && one.second.sha256 == other.second.sha256;
  });
}

nlohmann::json to_json(const FileStamps& stamps) {
  nlohmann::json document = nlohmann::json::object();
  for (const auto& [file, stamp] : stamps)
    document[file] = {{"sha256", stamp.sha256}, {"bytes", stamp.bytes}, {"modified_ns", stamp.modified_ns}};
  return document;
}

FileStamps parse_stamps(const nlohmann::json& document) {
  FileStamps stamps;
  for (const auto& [file, stamp] : document.items())
    stamps[file] = {stamp.at("sha256"), stamp.at("bytes"), stamp.at("modified_ns")};
  return stamps;
}

}  // namespace station
