// Tajima DST embroidery files: 512 characters of header (LA: label, ST: records, CO: colour changes, extents), then
// records of three bytes. Each moves by up to 12.1 mm along either axis in tenths of a millimetre, written in balanced
// ternary: digits of 1, 3, 9, 27 and 81, a bit for each sign. There are no colours. Three jumps or more in a row stand
// for a cut thread, as machines take them; fewer are one long stitch. Format:
// edutechwiki.unige.ch/en/Embroidery_format_DST
#pragma once

#include <string>
#include <string_view>

#include "renderer/embroidery/motif.h"

namespace station {

// Errors: std::runtime_error, one line naming `source`: no header, cut short, no stitch.
renderer::Motif parse_dst(std::string_view bytes, const std::string& source);

}  // namespace station
