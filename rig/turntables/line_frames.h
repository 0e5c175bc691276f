// Cuts the bytes of a line into the controller's lines of text, however the bytes were split or joined on their way.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "rig/devices/clock.h"
#include "rig/turntables/byte_line.h"

namespace rig {

class LineFrames {
 public:
  void add(std::string_view bytes);
  std::optional<std::string> next();  // the next whole line, without its line end; empty lines are left out
  void clear() { waiting_.clear(); }

 private:
  // Characters in the longest line of any controller; a longer one is noise, and its beginning is dropped.
  static constexpr std::size_t kLongest = 1024;
  std::string waiting_;
};

// Hands every line of text to `take` until that returns true. Returns false when `timeout_s` passes before, or when
// thousands of lines came, which is more than any controller says. With `timeout_s` 0 only the lines that are there
// already are handed over.
bool listen(ByteLine& line, LineFrames& frames, Clock& clock, double timeout_s,
            const std::function<bool(const std::string&)>& take);

// The first 60 characters of what a device said, for messages to people; unprintable ones become "?".
std::string printable(std::string_view text);

}  // namespace rig
