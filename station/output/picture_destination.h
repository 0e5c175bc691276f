// Whether a rendered picture can be written where it is wanted, asked before the work and not after it.
#pragma once

#include <filesystem>

namespace station {

// Errors: std::runtime_error, one line, for an ending that is neither .exr nor .png, and a folder that is not there.
void check_picture_destination(const std::filesystem::path& out);

}  // namespace station
