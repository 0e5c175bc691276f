#include "station/session/record/session_folder.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "station/documents/disk/file_name.h"
#include "station/documents/disk/folder_lock.h"
#include "station/documents/disk/sha256.h"
#include "station/documents/disk/stored_file.h"
#include "station/documents/plan_file.h"
#include "station/documents/reader.h"

namespace station {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;
constexpr std::array kSubfolders = {"raw", "calibration", "linear", "masks", "result", "refused"};
constexpr const char* kSessionFile = "session.json";
constexpr const char* kJournalFile = "journal.jsonl";

void require_name(const std::string& name) {
  if (const std::optional<std::string> problem = problem_with_name(name)) throw std::runtime_error(*problem);
}

std::string last_name(const fs::path& folder) {
  const fs::path normal = fs::absolute(folder).lexically_normal();
  return (normal.has_filename() ? normal : normal.parent_path()).filename().string();
}

// The folder's true path: a person may name a session by a link, while links inside it are refused.
fs::path true_place(const fs::path& folder) {
  const fs::path place = (folder / "").parent_path();  // without a slash at its end
  return fs::is_symlink(place) ? fs::weakly_canonical(place) : place;
}

// A link in the place of a folder would lead the pictures elsewhere.
bool is_true_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() == fs::file_type::directory;
}

bool is_empty_or_absent(const fs::path& folder) {
  return !fs::exists(folder) || fs::is_empty(folder);
}

// create() makes the lock first and session.json last, and nothing else in between.
bool is_unfinished(const fs::path& folder) {
  const bool known = std::all_of(fs::directory_iterator(folder), fs::directory_iterator(), [](const auto& entry) {
    const std::string name = entry.path().filename().string();
    return name == kLockFile || is_left_over(entry.path()) ||
           std::find(kSubfolders.begin(), kSubfolders.end(), name) != kSubfolders.end();
  });
  return known && fs::exists(folder / kLockFile) && is_empty_or_absent(folder / "raw");
}

void require_room_for_a_session(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder))
    throw std::runtime_error("'" + folder.string() + "' is a file, a session needs a folder; choose another name");
  if (is_session(folder))
    throw std::runtime_error("'" + folder.string() + "' is a session already; resume it, or choose another name");
  if (!fs::is_empty(folder) && !is_unfinished(folder)) {
    throw std::runtime_error("'" + folder.string() +
                             "' holds other files and is no session; choose a new or an empty folder");
  }
}

void make_subfolders(const fs::path& folder) {
  for (const char* name : kSubfolders) make_folder(folder / name);
}

std::runtime_error not_whole(const fs::path& folder, const std::string& found) {
  return std::runtime_error("the session '" + folder.string() + "' " + found + "; restore it from a copy");
}

void require_whole(const fs::path& folder) {
  if (!is_session(folder)) {
    throw std::runtime_error("'" + folder.string() +
                             "' is no session (it has no session.json); check the path, or start a new session there");
  }
  for (const char* name : kSubfolders) {
    const bool holds_the_record = std::string_view(name) == "raw" || std::string_view(name) == "calibration";
    const bool there = fs::exists(fs::symlink_status(folder / name));
    // Folders of derived files may be missing, because archives and copies leave empty folders out.
    if ((there || holds_the_record) && !is_true_folder(folder / name))
      throw not_whole(folder, "has no folder " + std::string(name) + "/");
  }
}

Plan plan_of(const json& session, const fs::path& file) {
  ObjectReader reader(session, file.string(), "session");
  return plan_from_json(reader.raw("plan"), file.string());
}

void store_calibration(const fs::path& folder, const CalibrationFiles& calibration, FileSystem& file_system) {
  for (const auto& [name, bytes] : calibration) {
    require_name(name);
    store_file(file_system, folder / "calibration" / name, bytes);
  }
}

}  // namespace

bool is_session(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / kSessionFile, ignored);
}

SessionFolder SessionFolder::create(const fs::path& asked, const json& session, const CalibrationFiles& calibration,
                                    rig::Clock& clock, FileSystem& file_system) {
  require_name(last_name(asked));
  const fs::path folder = true_place(asked);
  plan_of(session, folder / kSessionFile);
  OpenFile lock;
  try {
    require_room_for_a_session(folder);
    make_folder(folder);
    lock = lock_folder(folder, file_system);
    require_room_for_a_session(folder);  // another process may have been quicker
    make_subfolders(folder);
    store_calibration(folder, calibration, file_system);
  } catch (const std::system_error& error) {
    throw std::runtime_error(write_problem(folder, error.code()));
  }
  const std::string text = session.dump(2) + "\n";
  store_file(file_system, folder / kSessionFile, std::as_bytes(std::span(text)));
  return SessionFolder(folder, std::move(lock), clock, file_system);
}

SessionFolder SessionFolder::open(const fs::path& asked, rig::Clock& clock, FileSystem& file_system) {
  const fs::path folder = true_place(asked);
  require_whole(folder);
  OpenFile lock = lock_folder(folder, file_system);
  make_subfolders(folder);
  return SessionFolder(folder, std::move(lock), clock, file_system);
}

SessionFolder::SessionFolder(const fs::path& folder, OpenFile lock, rig::Clock& clock, FileSystem& file_system)
    : path_(folder),
      lock_(std::move(lock)),
      file_system_(&file_system),
      session_(read_json_file(folder / kSessionFile)),
      plan_(plan_of(session_, folder / kSessionFile)),
      journal_(folder / kJournalFile, clock, file_system) {
  // The first record is on the disk before the first picture, so an interruption cannot have caused this.
  if (journal_.records().empty() && !picture_names().empty())
    throw not_whole(folder, "has pictures, but its journal is missing or empty");
  json removed = json::array();
  for (const fs::path& place : {path_, path_ / "raw", path_ / "refused", path_ / "calibration"})
    for (const std::string& name : remove_left_overs(place))
      removed.push_back((place / name).lexically_relative(path_).string());
  if (!removed.empty()) append("left_overs_removed", {{"files", removed}});
}

std::string SessionFolder::store_picture(const std::string& name, std::span<const std::byte> bytes) {
  require_name(name);
  const fs::path file = path_ / "raw" / name;
  if (fs::exists(fs::symlink_status(file))) {
    throw std::runtime_error("'" + file.string() +
                             "' is there already and pictures are never overwritten; resume the session");
  }
  return store_file(*file_system_, file, bytes);
}

// A free name of the form refused/<stem>-<number>.<extension>.
fs::path SessionFolder::free_place(const std::string& name) const {
  const fs::path wanted = name;
  for (int number = 1;; ++number) {
    fs::path file =
        path_ / "refused" / (wanted.stem().string() + "-" + std::to_string(number) + wanted.extension().string());
    if (!fs::exists(fs::symlink_status(file))) return file;
  }
}

void SessionFolder::set_aside(const std::string& name) {
  const fs::path file = path_ / "raw" / name;
  if (!fs::exists(fs::symlink_status(file))) return;
  try {
    file_system_->rename(file, free_place(name));
    file_system_->sync_folder(path_ / "refused");
    file_system_->sync_folder(path_ / "raw");
  } catch (const std::system_error& error) {
    throw std::runtime_error(write_problem(file, error.code()));
  }
}

SessionFolder::Stored SessionFolder::store_refused(const std::string& name, std::span<const std::byte> bytes) {
  require_name(name);
  const fs::path file = free_place(name);
  std::string sha256 = store_file(*file_system_, file, bytes);
  return {.file = file.lexically_relative(path_).string(), .sha256 = std::move(sha256)};
}

std::vector<std::string> SessionFolder::picture_names() const {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_ / "raw"))
    if (!is_left_over(entry.path())) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::map<std::string, std::string> SessionFolder::hashes_of_fixed_files() const {
  std::map<std::string, std::string> hashes = {{kSessionFile, sha256_of_file(path_ / kSessionFile)}};
  for (const fs::directory_entry& entry : fs::directory_iterator(path_ / "calibration"))
    if (entry.is_regular_file())
      hashes["calibration/" + entry.path().filename().string()] = sha256_of_file(entry.path());
  return hashes;
}

}  // namespace station
