// Brother PES embroidery files: "#PES", a version, where the PEC section begins; that section has a label, the threads'
// colours by number in Brother's chart, and the stitches: moves in tenths of a millimetre, y downwards, each coordinate
// in one byte (7 bits) or two (12 bits with flags for jump and trim). Format:
// edutechwiki.unige.ch/en/Embroidery_format_PEC
#pragma once

#include <string>
#include <string_view>

#include "renderer/embroidery/motif.h"

namespace station {

// Errors: std::runtime_error, one line naming `source`: another kind of file, offsets that lead outside of it, cut
// short, more colour changes than colours, no stitch.
renderer::Motif parse_pes(std::string_view bytes, const std::string& source);

}  // namespace station
