// The parser of a reply in the Zaber ASCII protocol. It is strict: alerts, information lines and noise are no replies.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rig {

struct ZaberReply {
  int device = 0, axis = 0;
  std::optional<int> message;  // the number that the question carried
  bool accepted = false;       // "OK"; false: "RJ"
  bool busy = false;           // "BUSY"; false: "IDLE"
  std::string warning;         // two letters, "--" for none
  std::string data;            // the answer, or the reason for a rejection
};

// The reply in a line like "@01 1 05 OK BUSY -- 1234:8C"; nothing when the line is none or its check sum is wrong. The
// message number and the check sum may be missing.
std::optional<ZaberReply> parse_zaber_line(std::string_view line);

// The check sum, two hexadecimal digits, of `text`: what stands between a line's first character and its colon.
std::string zaber_check_sum(std::string_view text);

// The words that tell the person at the turntable what a warning or a rejection means.
std::string zaber_warning_words(const std::string& warning);
std::string zaber_rejection_words(const std::string& reason);

}  // namespace rig
