// Any bytes as a WIF file: they are read, or refused with a message.
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "station/documents/wif_file.h"
#include "tests/station/documents/fuzz/fuzzed_draft.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::optional<renderer::Draft> draft;
  try {
    draft = station::parse_wif(std::string(reinterpret_cast<const char*>(data), size), "draft.wif");
  } catch (const std::runtime_error&) {
  }
  if (draft) station::expect_usable(*draft);
  return 0;
}
