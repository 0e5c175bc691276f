// Files of earlier days written anew in the versions of today (documents/migrations.h). Every command reads them as
// they are; this is for other programs that read our files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace station {

struct UpgradedFile {
  std::filesystem::path file;
  std::filesystem::path copy;  // of the file as it was
};

// Upgrades a file, or all documents in a folder and the folders in it; what is of today, and what is no document of
// ours, stays as it is. Copies go to a new folder `before-upgrade` (or -2, -3, ...) in that folder, or in that of the
// file. A session's journal records the new hashes, and a manifest beside a file is made anew. A library's threads stay
// as they are: their hashes are their names there. Errors: std::runtime_error, one line: no such place, a file made by
// a later threadstation, a session in use, a file that cannot be written.
std::vector<UpgradedFile> upgrade_files(const std::filesystem::path& file_or_folder);

}  // namespace station
