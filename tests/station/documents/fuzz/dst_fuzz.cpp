// Any bytes as a Tajima DST file: it is read, or refused with a message.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "station/documents/dst_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    station::parse_dst(std::string_view(reinterpret_cast<const char*>(data), size), "motif.dst");
  } catch (const std::runtime_error&) {
  }
  return 0;
}
