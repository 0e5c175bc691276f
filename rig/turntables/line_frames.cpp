#include "rig/turntables/line_frames.h"

#include <algorithm>

namespace rig {
namespace {

constexpr int kMostFrames = 4000;  // lines and reads while one answer is awaited

}  // namespace

void LineFrames::add(std::string_view bytes) {
  waiting_.append(bytes);
  const std::size_t last_end = waiting_.find_last_of("\r\n");
  const std::size_t begin = last_end == std::string::npos ? 0 : last_end + 1;
  if (waiting_.size() - begin > kLongest) waiting_.erase(begin, waiting_.size() - begin - kLongest);
}

std::optional<std::string> LineFrames::next() {
  const std::size_t begin = waiting_.find_first_not_of("\r\n");
  if (begin == std::string::npos) {
    waiting_.clear();
    return std::nullopt;
  }
  const std::size_t end = waiting_.find_first_of("\r\n", begin);
  if (end == std::string::npos) {
    waiting_.erase(0, begin);
    return std::nullopt;
  }
  std::string line = waiting_.substr(begin, end - begin);
  waiting_.erase(0, end);
  return line;
}

bool listen(ByteLine& line, LineFrames& frames, Clock& clock, double timeout_s,
            const std::function<bool(const std::string&)>& take) {
  const double until_s = clock.monotonic_s() + timeout_s;
  for (int count = 0; count < kMostFrames; ++count) {
    while (const auto text = frames.next()) {
      ++count;
      if (take(*text)) return true;
    }
    const std::string bytes = line.read(std::max(0.0, until_s - clock.monotonic_s()));
    if (bytes.empty()) return false;
    frames.add(bytes);
  }
  return false;
}

std::string printable(std::string_view text) {
  std::string words;
  for (const char c : text.substr(0, 60)) words += c >= ' ' && c < '\x7f' ? c : '?';
  return words;
}

}  // namespace rig
