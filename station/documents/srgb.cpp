#include "station/documents/srgb.h"

#include <charconv>
#include <stdexcept>

namespace station {

std::optional<Srgb8> hex_colour(const std::string& text) {
  const char* end = text.data() + text.size();
  unsigned int rgb = 0;
  if (text.size() != 7 || text[0] != '#' || std::from_chars(text.data() + 1, end, rgb, 16).ptr != end)
    return std::nullopt;
  return Srgb8{static_cast<unsigned char>(rgb >> 16), static_cast<unsigned char>(rgb >> 8 & 255),
               static_cast<unsigned char>(rgb & 255)};
}

Srgb8 parse_colour(const std::string& text) {
  if (const auto colour = hex_colour(text)) return *colour;
  throw std::runtime_error("found the colour \"" + text + "\", expected one like \"#c01830\"");
}

}  // namespace station
