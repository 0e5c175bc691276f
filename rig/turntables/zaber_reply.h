// One line of the Zaber ASCII protocol, read strictly: replies only; alerts, information and noise are nothing.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rig {

struct ZaberReply {
  int device = 0, axis = 0;
  std::optional<int> message;  // the number that the question carried
  bool accepted = false;       // OK, not RJ
  bool busy = false;           // BUSY, not IDLE
  std::string warning;         // two letters, "--" for none
  std::string data;            // the answer, or why it was rejected
};

// "@01 1 05 OK BUSY -- 1234:8C": the message number and the check sum may be missing; a wrong check sum is noise.
std::optional<ZaberReply> parse_zaber_line(std::string_view line);

// Two hexadecimal digits over what stands between a line's first character and its colon.
std::string zaber_check_sum(std::string_view text);

// What a warning or a rejection means to the person at the turntable.
std::string zaber_warning_words(const std::string& warning);
std::string zaber_rejection_words(const std::string& reason);

}  // namespace rig
