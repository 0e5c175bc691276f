#include "rig/cameras/ptp_bytes.h"

namespace rig {

PtpWriter& PtpWriter::bytes(std::string_view raw) {
  bytes_.append(raw);
  return *this;
}

PtpWriter& PtpWriter::text(std::string_view ascii) {
  if (ascii.empty()) return put(std::uint8_t{0});
  put(static_cast<std::uint8_t>(ascii.size() + 1));
  return wide_text(ascii);
}

PtpWriter& PtpWriter::wide_text(std::string_view ascii) {
  for (const char c : ascii) put(static_cast<std::uint16_t>(static_cast<unsigned char>(c)));
  return put(std::uint16_t{0});
}

}  // namespace rig
