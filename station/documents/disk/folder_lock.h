// A lock that keeps all but one process out of a session: it is held on the file `.lock` in the session's folder and
// given back when the process ends, however it ends.
#pragma once

#include <filesystem>
#include <optional>

#include "station/documents/disk/file_system.h"

namespace station {

// Takes the lock, which is held as long as the returned file is open. The file contains the number of the process that
// holds it. Errors: std::runtime_error that says which process holds the lock, or why it cannot be made.
OpenFile lock_folder(const std::filesystem::path& folder, FileSystem& file_system);

// The same for a folder of any kind; nothing when another process holds it.
std::optional<OpenFile> try_lock_folder(const std::filesystem::path& folder, FileSystem& file_system);
// The number of the process that holds or held the lock last, on the computer where it ran; 0: nobody yet.
int holder_of_lock(const std::filesystem::path& folder);

// Whether a process holds the folder's lock now. Changes nothing.
bool folder_in_use(const std::filesystem::path& folder);

inline constexpr const char* kLockFile = ".lock";

}  // namespace station
