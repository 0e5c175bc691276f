// A file that is either there whole or not there: written to a temporary name in its folder, flushed, read again and
// compared, renamed, and the folder flushed.
//
// Errors: std::runtime_error with one line that names the file, what the system said and what to do; the temporary
// file is removed and nothing stands at the final name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "station/capture/file_system.h"

namespace station {

// Returns the SHA-256 of `bytes`. `file` is replaced when it exists.
std::string store_file(FileSystem& file_system, const std::filesystem::path& file, std::span<const std::byte> bytes);

// Before long work: throws what store_file would if nothing can be written to `file`, and leaves nothing behind.
void check_can_store(FileSystem& file_system, const std::filesystem::path& file);

// Makes a folder that may be there already. Errors as above.
void make_folder(const std::filesystem::path& folder);

// Removes what a killed store_file left in `folder`; returns the names.
std::vector<std::string> remove_left_overs(const std::filesystem::path& folder);

bool is_left_over(const std::filesystem::path& file);

// "could not write 'raw/x.arw': No space left on device; free space ..., then go on"
std::string write_problem(const std::filesystem::path& file, const std::error_code& code);

}  // namespace station
