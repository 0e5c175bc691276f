#include "station/session/upgrade_files.h"

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>

#include "rig/devices/clock.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/disk/whole_file.h"
#include "station/documents/manifest.h"
#include "station/documents/migrations.h"
#include "station/documents/reader.h"
#include "station/session/record/session_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kCopies = "before-upgrade";
constexpr const char* kLibrary = "index.sqlite";

fs::path folder_for_copies(const fs::path& folder) {
  fs::path copies = folder / kCopies;
  for (int number = 2; fs::exists(copies); ++number)
    copies = folder / (std::string(kCopies) + "-" + std::to_string(number));
  return copies;
}

std::vector<fs::path> documents_in(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::exists(folder / kLibrary)) return files;
  fs::recursive_directory_iterator place(folder);
  for (const fs::recursive_directory_iterator end; place != end; ++place) {
    const fs::path& path = place->path();
    const bool passed = path.filename().string().starts_with(kCopies) || fs::exists(path / kLibrary);
    if (place->is_directory() && passed) place.disable_recursion_pending();
    if (place->is_regular_file() && path.extension() == ".json") files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The text of the file as of today; none where it is so already, or no document of ours.
std::optional<std::string> text_of_today(const fs::path& file) {
  const json document = read_json_file(file);
  const json today = up_to_date(document, file.string());
  if (today == document) return std::nullopt;
  return today.dump(2) + "\n";
}

// The session whose fixed file this is, if it is one.
std::optional<fs::path> session_of(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (file.filename() == "session.json" && is_session(folder)) return folder;
  if (folder.filename() == "calibration" && is_session(folder.parent_path())) return folder.parent_path();
  return std::nullopt;
}

void keep_copy(const fs::path& file, const fs::path& copy) {
  FileSystem disk;
  make_folder(copy.parent_path());
  store_file(disk, copy, bytes_of_file(file));
}

void write(const fs::path& file, const std::string& text) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  const ManifestReport manifest = check_manifest(folder);
  if (const auto session = session_of(file)) {
    FileSystem disk;
    rig::SystemClock clock;
    // Recorded first: where the plug is pulled in between, the same command does it again.
    SessionFolder::open(*session, clock, disk)
        .append("upgraded", {{"files", {{fs::relative(file, *session).string(), sha256_hex(text)}}}});
  }
  write_text_file(file, text);
  if (manifest.present && manifest.problems.empty()) {
    FileSystem disk;
    write_manifest(folder, disk);
  }
}

}  // namespace

std::vector<UpgradedFile> upgrade_files(const fs::path& place) {
  const bool is_folder = fs::is_directory(place);
  if (!is_folder && !fs::is_regular_file(place))
    throw std::runtime_error("there is no file or folder '" + place.string() + "'; check the name");
  const fs::path folder = is_folder ? place : place.has_parent_path() ? place.parent_path() : ".";
  // All are read before the first is written.
  std::map<fs::path, std::string> texts;
  for (const fs::path& file : is_folder ? documents_in(place) : std::vector<fs::path>{place})
    if (const auto text = text_of_today(file)) texts[file] = *text;
  const fs::path copies = folder_for_copies(folder);
  std::vector<UpgradedFile> upgraded;
  for (const auto& [file, text] : texts) {
    upgraded.push_back({file, copies / fs::relative(file, folder)});
    keep_copy(file, upgraded.back().copy);
    write(file, text);
  }
  return upgraded;
}

}  // namespace station
