// SHA-256 (FIPS 180-4) of bytes and of files, as 64 lower-case hexadecimal digits.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace station {

std::string sha256_hex(std::span<const std::byte> bytes);
std::string sha256_hex(std::string_view text);

// The hash of a file's content. Errors: std::runtime_error that names the file when it cannot be read to its end.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace station
