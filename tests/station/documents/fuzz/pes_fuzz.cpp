// Any bytes as a Brother PES file: it is read, or refused with a message.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "station/documents/pes_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    station::parse_pes(std::string_view(reinterpret_cast<const char*>(data), size), "motif.pes");
  } catch (const std::runtime_error&) {
  }
  return 0;
}
