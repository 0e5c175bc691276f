// Writing and reading of numbers, texts and lists in PTP's encoding: little endian, texts in UCS-2 with their length in
// front.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rig {

class PtpWriter {
 public:
  template <typename Number>
  PtpWriter& put(Number value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      bytes_ += static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xff);
    return *this;
  }
  PtpWriter& bytes(std::string_view raw);
  PtpWriter& text(std::string_view ascii);       // as a PTP string
  PtpWriter& wide_text(std::string_view ascii);  // as UCS-2 with a final 0, used in the packets that open a connection
  template <typename Number>
  PtpWriter& list(const std::vector<Number>& values) {
    put(static_cast<std::uint32_t>(values.size()));
    for (const Number value : values) put(value);
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// The little-endian number at `offset`; nothing when the bytes end before its end.
template <typename Number>
std::optional<Number> ptp_number(std::string_view bytes, std::size_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(Number)) return std::nullopt;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  return static_cast<Number>(value);
}

}  // namespace rig
