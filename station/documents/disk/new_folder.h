// The new folder that a command writes its results into.
#pragma once

#include <filesystem>

namespace station {

// Makes `folder`, or accepts it when it exists and is empty. Errors: std::runtime_error, one line, when it holds
// something, is no folder or cannot be made.
void make_new_folder(const std::filesystem::path& folder);

}  // namespace station
