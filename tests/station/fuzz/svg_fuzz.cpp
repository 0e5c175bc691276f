// Any bytes as a drawing: it is read, or refused with a message.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "station/documents/svg_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    station::parse_svg(std::string_view(reinterpret_cast<const char*>(data), size), "motif.svg");
  } catch (const std::runtime_error&) {
  }
  return 0;
}
