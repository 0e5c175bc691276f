// Embroidery files by their ending: .dst (Tajima), .pes (Brother), .svg (line art, digitised).
#pragma once

#include <filesystem>

#include "renderer/embroidery/motif.h"

namespace station {

// Errors: std::runtime_error, one line: no such file, another ending, more than 64 MiB, those of dst_file.h,
// pes_file.h, svg_file.h and renderer::digitise.
renderer::Motif read_motif(const std::filesystem::path& file);

}  // namespace station
