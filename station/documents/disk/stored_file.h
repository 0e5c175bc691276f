// Files that are either there whole or not there: each is written to a temporary name in its folder, flushed, read
// again and compared, then renamed, and the folder is flushed.
//
// Errors: std::runtime_error with one line that names the file, what the system said and what to do; the temporary file
// is removed and nothing stands at the final name.
#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "station/documents/disk/file_system.h"

namespace station {

// Stores `bytes` as `file`, replacing a file that is there, and returns their SHA-256.
std::string store_file(FileSystem& file_system, const std::filesystem::path& file, std::span<const std::byte> bytes);

// Throws what store_file would throw if nothing can be written to `file`, and leaves nothing behind; for calls before
// long work.
void check_can_store(FileSystem& file_system, const std::filesystem::path& file);

// Makes a folder unless it is there already. Errors: as above.
void make_folder(const std::filesystem::path& folder);

// Removes the temporary files that a killed store_file left in `folder` and returns their names.
std::vector<std::string> remove_left_overs(const std::filesystem::path& folder);

bool is_left_over(const std::filesystem::path& file);  // whether the name is that of such a temporary file

// What a person is told of an error: its words, and for those of std::filesystem such a line as "could not use
// 'sessions': Permission denied; give this user the right to use it or name another place".
std::string problem_line(const std::exception& error);

// The error line for a failed write, such as "could not write 'raw/x.arw': No space left on device; free space ...,
// then go on".
std::string write_problem(const std::filesystem::path& file, const std::error_code& code);

}  // namespace station
