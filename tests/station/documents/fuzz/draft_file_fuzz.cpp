// Any text as a draft file: it is read, or refused with a message.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "tests/station/documents/fuzz/fuzzed_draft.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const nlohmann::json document =
      nlohmann::json::parse(std::string_view(reinterpret_cast<const char*>(data), size), nullptr, false);
  if (document.is_discarded()) return 0;
  std::optional<renderer::Draft> draft;
  try {
    draft = station::parse_draft(document, "draft.json");
  } catch (const std::runtime_error&) {
  }
  if (draft) station::expect_usable(*draft);
  return 0;
}
