// All that stands in a file.
//
// Errors: std::runtime_error with one line when there is no such file, or when it cannot be read to its end.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace station {

std::string text_of_file(const std::filesystem::path& file);
std::vector<std::byte> bytes_of_file(const std::filesystem::path& file);

}  // namespace station
