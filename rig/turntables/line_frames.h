// Cuts what a line delivers into the controller's lines of text, however the bytes were split or glued on their way.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "rig/clock.h"
#include "rig/turntables/byte_line.h"

namespace rig {

class LineFrames {
 public:
  void add(std::string_view bytes);
  std::optional<std::string> next();  // without its line end; empty lines are left out
  void clear() { waiting_.clear(); }

 private:
  // No controller says so much in one line: what is longer is noise, and its beginning is dropped.
  static constexpr std::size_t kLongest = 1024;
  std::string waiting_;
};

// Hands every line of text to `take` until it says that it has what it wants; false when nothing more came in time.
// With `timeout_s` 0: what has come already. Ends too when it has heard far more than any controller says.
bool listen(ByteLine& line, LineFrames& frames, Clock& clock, double timeout_s,
            const std::function<bool(const std::string&)>& take);

// The beginning of what a device said, for people.
std::string printable(std::string_view text);

}  // namespace rig
