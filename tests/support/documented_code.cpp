#include "tests/support/documented_code.h"

#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

namespace {

struct Words {
  std::set<int> groups;           // modal groups that had a word
  std::map<char, double> values;  // all letters but G and M
  bool dwell = false, machine = false, offset = false, no_offset = false, motion = false;
};

// Modal group of a G word, by ten times its number; nothing when it is not supported here.
std::optional<int> group_of(int tenths) {
  switch (tenths) {
    case 0:
    case 10:
    case 800:
      return 1;
    case 40:
    case 530:
    case 920:
    case 921:
      return 0;
    case 170:
    case 180:
    case 190:
      return 2;
    case 900:
    case 910:
      return 3;
    case 911:
      return 4;
    case 940:
      return 5;
    case 200:
    case 210:
      return 6;
    case 400:
      return 7;
    case 490:
      return 8;
    case 540:
    case 550:
    case 560:
    case 570:
    case 580:
    case 590:
      return 12;
    default:
      return std::nullopt;
  }
}

bool allowed_in_jog(int tenths) {
  return tenths == 200 || tenths == 210 || tenths == 900 || tenths == 910 || tenths == 530;
}

int take_g(double value, bool jog, Words& words, DocumentedModes& modes) {
  const int tenths = static_cast<int>(std::lround(value * 10));
  const auto group = group_of(tenths);
  if (!group || std::abs(value * 10 - tenths) > 1e-6) return 20;
  if (jog && !allowed_in_jog(tenths)) return 16;
  if (!words.groups.insert(*group).second) return 21;
  if (*group == 1) {
    modes.motion = tenths / 10;
    words.motion = tenths != 800;
  }
  if (*group == 3) modes.incremental = tenths == 910;
  if (*group == 6) modes.inches = tenths == 200;
  if (*group == 12) modes.system = tenths / 10;
  words.dwell = words.dwell || tenths == 40;
  words.machine = words.machine || tenths == 530;
  words.offset = words.offset || tenths == 920;
  words.no_offset = words.no_offset || tenths == 921;
  return 0;
}

int take_m(double value) {
  static const std::set<double> kKnown{0, 1, 2, 3, 4, 5, 7, 8, 9, 30};
  return kKnown.contains(value) ? 0 : 20;
}

int take_value(char letter, double value, bool jog, Words& words) {
  static const std::string kKnown = "FXYZPNST", kKnownInJog = "FXYZN";
  if ((jog ? kKnownInJog : kKnown).find(letter) == std::string::npos) return jog ? 16 : 36;
  if (letter == 'F' && value < 0) return 4;
  return words.values.emplace(letter, value).second ? 0 : 25;
}

// Splits the line into words; returns the error, 0 for none.
int take_words(const std::string& line, bool jog, Words& words, DocumentedModes& modes) {
  for (std::size_t at = 0; at < line.size();) {
    const char letter = line[at++];
    if (letter < 'A' || letter > 'Z') return 1;
    const std::size_t end = std::min(line.find_first_not_of("+-.0123456789", at), line.size());
    const std::string number = line.substr(at, end - at);
    char* rest = nullptr;
    const double value = std::strtod(number.c_str(), &rest);
    if (number.empty() || *rest != '\0') return 2;
    at = end;
    const int error = letter == 'G'   ? take_g(value, jog, words, modes)
                      : letter == 'M' ? (jog ? 16 : take_m(value))
                                      : take_value(letter, value, jog, words);
    if (error != 0) return error;
  }
  return 0;
}

int error_of(const Words& words, bool jog, bool has_axes, const DocumentedModes& modes) {
  if (words.offset && words.motion && has_axes) return 24;
  if (words.dwell && !words.values.contains('P')) return 28;
  if (!words.dwell && words.values.contains('P')) return 36;
  if (words.offset && !has_axes) return 26;
  if (jog) return !has_axes ? 26 : words.values.contains('F') && words.values.at('F') > 0 ? 0 : 22;
  if (words.machine && modes.motion > 1) return 30;
  if (has_axes && !words.offset && modes.motion == 80) return 31;
  if (has_axes && !words.offset && modes.motion == 1 && modes.feed <= 0) return 22;
  return 0;
}

}  // namespace

std::variant<DocumentedCode, int> read_documented_code(const std::string& line, bool jog, DocumentedModes& modes) {
  Words words;
  DocumentedModes next = modes;
  if (const int error = take_words(line, jog, words, next)) return error;
  const double mm = next.inches ? kMmPerInch : 1;
  if (!jog && words.values.contains('F')) next.feed = words.values.at('F') * mm;
  DocumentedCode code;
  bool has_axes = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto value = words.values.find("XYZ"[axis]);
    if (value == words.values.end()) continue;
    code.axes[axis] = value->second * mm;
    has_axes = true;
  }
  if (const int error = error_of(words, jog, has_axes, next)) return error;
  using enum DocumentedCode::Kind;
  code.kind = words.dwell ? dwell : words.no_offset ? no_offset : words.offset ? offset : has_axes ? move : nothing;
  code.rapid = !jog && next.motion == 0;
  code.incremental = next.incremental;
  code.machine = words.machine;
  code.feed = jog ? words.values.at('F') * mm : next.feed;
  code.dwell_s = words.dwell ? words.values.at('P') : 0;
  if (!jog) modes = next;
  return code;
}
