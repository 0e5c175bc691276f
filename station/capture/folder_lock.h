// One process at a time works on a session: a lock on the file `.lock` in its folder, given back when the process
// ends, however it ends.
#pragma once

#include <filesystem>

#include "station/capture/file_system.h"

namespace station {

// Held while the returned file is open. The file carries the number of the process that holds it.
// Errors: std::runtime_error that says which process holds the lock, or why it cannot be made.
OpenFile lock_folder(const std::filesystem::path& folder, FileSystem& file_system);

// Whether a process holds it now. Changes nothing.
bool folder_in_use(const std::filesystem::path& folder);

inline constexpr const char* kLockFile = ".lock";

}  // namespace station
