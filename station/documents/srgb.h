// A colour as people write it: sRGB with eight bits a channel.
#pragma once

#include <array>
#include <optional>
#include <string>

namespace station {

using Srgb8 = std::array<unsigned char, 3>;
// The colour that "#rrggbb" writes, or nothing for any other text.
std::optional<Srgb8> hex_colour(const std::string& text);
// The same colour. Errors: std::runtime_error, one line, for any other text.
Srgb8 parse_colour(const std::string& text);

}  // namespace station
