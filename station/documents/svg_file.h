// Line art as embroidery: what a drawing (SVG) strokes is sewn, each element in its stroke's colour and in the drawing's order.
//
//   stroke narrower than 0.8 mm | running stitches along the line, up to 2.5 mm long, shorter where it bends, a needle point at
//                               | every corner
//   wider                       | satin: to and fro across the line, as wide as the stroke, 0.35 mm from one thread to the next
//   no stroke, but a fill       | the outline in the fill's colour, as running stitches
//
// Sizes are those of the page (width and height with their unit over the viewBox; without a unit 96 to the inch). Read are
// path, line, polyline, polygon, rect, circle, ellipse in groups with transforms; presentation attributes, style attributes
// and rules of single classes. Consecutive elements of one colour share a thread.
// Format: w3.org/TR/SVG11
#pragma once

#include <string>
#include <string_view>

#include "renderer/embroidery/motif.h"

namespace station {

// Errors: std::runtime_error, one line naming `source`: no drawing, a length, transform, path or colour that cannot be read,
// text, images and references (which have no lines of their own), gradients, nothing to sew, lines outside of 10 m, more
// than renderer::kMostStitches.
renderer::Motif parse_svg(std::string_view text, const std::string& source);

}  // namespace station
