// Any bytes as a drawing: it is read and sewn, or refused with a message.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "renderer/embroidery/digitise.h"
#include "station/documents/svg_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    renderer::digitise(station::parse_svg(text, "motif.svg"), "motif.svg");
  } catch (const std::runtime_error&) {
  }
  return 0;
}
