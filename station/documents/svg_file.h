// Drawings (SVG) as line art: what a drawing strokes as lines, what it fills as shapes, each in its colour and in the
// drawing's order. An element of class "direction" is not sewn: it is the direction, from its first point to its last,
// of the stitches that fill shapes of its group and of the groups within that have none of their own; of several the
// one that is nearest to the middle of a shape.
//
// Sizes are those of the page (width and height with their unit over the viewBox; without a unit 96 to the inch). Read
// are path, line, polyline, polygon, rect, circle, ellipse in groups with transforms; presentation attributes, style
// attributes and rules of single classes. Format: w3.org/TR/SVG11
#pragma once

#include <string>
#include <string_view>

#include "renderer/embroidery/line_art.h"

namespace station {

// Errors: std::runtime_error, one line naming `source`: no drawing, a length, transform, path or colour that cannot be
// read, text, images and references (which have no lines of their own), gradients, nothing to sew, lines outside of 10
// m, more than 2 km of lines.
renderer::LineArt parse_svg(std::string_view text, const std::string& source);

}  // namespace station
