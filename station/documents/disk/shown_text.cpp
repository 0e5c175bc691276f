#include "station/documents/disk/shown_text.h"

#include <array>

namespace station {
namespace {

// The number of bytes of the character with which the text begins; 0 where it begins with none that can be shown.
std::size_t character_at(std::string_view text) {
  struct Kind {
    unsigned mask, begin;
    char32_t least;  // that needs so many bytes
  };
  constexpr std::array<Kind, 4> kKinds{
      Kind{0x80, 0x00, 0}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}};
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(text[i])); };
  for (std::size_t bytes = 1; bytes <= kKinds.size() && bytes <= text.size(); ++bytes) {
    const auto& [mask, begin, least] = kKinds.at(bytes - 1);
    if ((byte(0) & mask) != begin) continue;
    char32_t code = byte(0) & ~mask;
    for (std::size_t i = 1; i < bytes; ++i) {
      if ((byte(i) & 0xc0U) != 0x80U) return 0;
      code = code << 6U | (byte(i) & 0x3fU);
    }
    const bool control = code < 0x20 || (code >= 0x7f && code < 0xa0) || (code >= 0x202a && code <= 0x202e);
    const bool none = code < least || code > 0x10ffff || (code >= 0xd800 && code <= 0xdfff);
    return control || none ? 0 : bytes;
  }
  return 0;
}

}  // namespace

std::string shown_text(std::string_view text, std::size_t most) {
  std::string shown;
  for (std::size_t characters = 0; !text.empty(); ++characters) {
    if (characters == most) return shown + "...";
    const std::size_t bytes = character_at(text);
    shown += bytes == 0 ? "?" : text.substr(0, bytes);
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return shown;
}

}  // namespace station
