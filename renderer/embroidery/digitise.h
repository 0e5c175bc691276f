// Line art as stitches, each line or shape in its colour and in the order of drawing.
//
//   narrower than 0.8 mm | running stitches along the line, up to 2.5 mm long, shorter where it bends, a needle point
//                        | at every corner
//   wider                | satin: to and fro across the line, as wide as the stroke, 0.35 mm from one thread to the
//                        | next
//   filled shape         | rows of stitches side by side, 0.35 mm apart, about 4 mm long and offset from row to row,
//                        | along the direction that was drawn for it, or along its own longer side
#pragma once

#include <string>

#include "renderer/embroidery/line_art.h"
#include "renderer/embroidery/motif.h"

namespace renderer {

// Neighbouring lines of one colour share a thread. Errors: std::runtime_error, one line naming `source`, when there
// would be more than kMostStitches (stitch_curves.h).
Motif digitise(const LineArt& art, const std::string& source);

}  // namespace renderer
