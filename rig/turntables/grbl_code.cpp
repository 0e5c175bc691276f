#include "rig/turntables/grbl_code.h"

#include <cctype>
#include <cmath>
#include <string_view>
#include <vector>

#include "rig/turntables/reply_text.h"

namespace rig {
namespace {

struct Word {
  char letter;
  double value;
};

// Splits the line into words of letter and number; returns a status code when that fails.
std::optional<GrblStatusCode> read_words(const std::string& line, std::vector<Word>& words) {
  std::string text;
  for (const char c : line)
    if (c != ' ') text += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (std::size_t at = 0; at < text.size();) {
    const char letter = text[at++];
    if (letter < 'A' || letter > 'Z') return kExpectedLetter;
    std::size_t end = at;
    while (end < text.size() &&
           (text[end] == '-' || text[end] == '+' || text[end] == '.' || (text[end] >= '0' && text[end] <= '9')))
      ++end;
    const auto value = number_from<double>(std::string_view(text).substr(at, end - at));
    if (!value) return kBadNumber;
    words.push_back({letter, *value});
    at = end;
  }
  return std::nullopt;
}

// Takes a G code into the line or the modes; false when the code is unknown.
bool take_code(int code, GrblCode& line, GrblModes& modes) {
  if (code == 0 || code == 1)
    modes.rapid = code == 0;
  else if (code == 4)
    line.dwell_s = 0;
  else if (code == 53)
    line.machine = true;
  else if (code == 90 || code == 91)
    line.incremental = code == 91;
  else if (code == 92)
    line.sets_offset = true;
  else
    return code == 21 || code == 94 || code == 54;
  return true;
}

}  // namespace

std::variant<GrblCode, GrblStatusCode> parse_grbl_code(const std::string& text, bool jog, GrblModes& modes) {
  std::vector<Word> words;
  if (const auto status = read_words(text, words)) return *status;
  GrblCode line{.incremental = modes.incremental, .feed_deg_min = jog ? 0 : modes.feed_deg_min};
  double pause_s = 0;
  for (const Word& word : words) {
    switch (word.letter) {
      case 'G':
        if (!take_code(static_cast<int>(std::lround(word.value)), line, modes)) return kUnknownCode;
        break;
      case 'X':
        line.x_deg = word.value;
        break;
      case 'F':
        line.feed_deg_min = word.value;
        break;
      case 'P':
        pause_s = word.value;
        break;
      case 'M':
      case 'S':
      case 'T':
      case 'N':
        break;
      default:
        return kUnknownCode;
    }
  }
  if (line.dwell_s) line.dwell_s = pause_s;
  line.rapid = modes.rapid && !jog;
  line.moves = line.x_deg.has_value() && !line.sets_offset;
  if (line.moves && !line.rapid && !(line.feed_deg_min > 0)) return kNoFeed;
  if (jog && !line.x_deg) return kAxisMissing;
  if (!jog) {
    modes.incremental = line.incremental;
    modes.feed_deg_min = line.feed_deg_min;
  }
  return line;
}

}  // namespace rig
