// Embroidery files by their ending: .dst (Tajima), .pes (Brother).
#pragma once

#include <filesystem>

#include "renderer/embroidery/motif.h"

namespace station {

// Errors: std::runtime_error, one line: no such file, another ending, more than 64 MiB, those of dst_file.h and pes_file.h.
renderer::Motif read_motif(const std::filesystem::path& file);

}  // namespace station
