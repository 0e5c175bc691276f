// What the picture formats share: whole files in memory, and refusals of one line.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace renderer {

inline constexpr double kMostPicturePixels = 1e8;  // of a picture that is read

// Throws std::runtime_error with one line, whatever a library's own words contain.
[[noreturn]] void refuse_picture(const std::string& asked, const std::string& found, const std::string& remedy);
// Of a file that is damaged: "reading picture FILE: `found`; it is damaged ...".
[[noreturn]] void refuse_damaged_picture(const std::filesystem::path& file, const std::string& found);

// Errors: std::runtime_error for what is no file or cannot be read.
std::string bytes_of_picture(const std::filesystem::path& file);

// To a temporary name beside it, flushed and renamed, so that `file` is the old or the new one whole.
// Errors: std::runtime_error for a folder that is not there and a disk that is full.
void store_picture(const std::filesystem::path& file, std::string_view bytes);

}  // namespace renderer
