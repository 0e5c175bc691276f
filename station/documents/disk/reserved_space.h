// Room on a disk that is held while long work is done, so that its result finds room when all else has filled the disk.
#pragma once

#include <cstdint>
#include <filesystem>

#include "station/documents/disk/file_system.h"

namespace station {

// Takes `bytes` of the disk on which `folder` lies, in a file without a name: it goes away when the returned file is
// closed, or the process ends, however it ends. Where the file system has no such files the returned file is none, and
// no room is held. Errors: std::runtime_error, one line that names the folder, when there is not so much room.
OpenFile reserve_space(const std::filesystem::path& folder, std::uintmax_t bytes);

}  // namespace station
