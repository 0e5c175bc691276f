// A colour as people write it: sRGB with eight bits a channel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

namespace station {

using Srgb8 = std::array<unsigned char, 3>;
// The nearest of linear sRGB, each channel clipped to 0 ... 1; and "#rrggbb".
Srgb8 srgb_of_linear(const Eigen::Vector3d& linear);
std::string hex_text(const Srgb8& colour);
// The colour that "#rrggbb" writes, or nothing for any other text.
std::optional<Srgb8> hex_colour(const std::string& text);
// The colour that CSS and SVG call so ("indigo"), or nothing for any other text.
std::optional<Srgb8> named_colour(const std::string& text);
// The colour that "#rrggbb", a name or "lab(L a b)" writes: CIELAB for D50, L of 0 to 100, as colour cards and
// spectrophotometers give it. Errors: std::runtime_error, one line, for any other text, and for a Lab colour that sRGB
// does not hold, with the nearest that it does.
Srgb8 parse_colour(const std::string& text);

}  // namespace station
