#include "rig/turntables/zaber_reply.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "rig/turntables/reply_text.h"

namespace rig {
namespace {

// Takes the text up to the next blank off the front of `text` and returns it.
std::string_view take_word(std::string_view& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

bool is_digits(std::string_view word, std::size_t count) {
  return word.size() == count && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_warning(std::string_view word) {
  return word == "--" || (word.size() == 2 && std::ranges::all_of(word, [](char c) { return c >= 'A' && c <= 'Z'; }));
}

}  // namespace

std::string zaber_check_sum(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  std::array<char, 4> digits{};
  std::snprintf(digits.data(), digits.size(), "%02X", (256 - sum % 256) % 256);
  return digits.data();
}

std::optional<ZaberReply> parse_zaber_line(std::string_view line) {
  if (!line.starts_with('@') || !is_plain(line)) return std::nullopt;
  std::string_view rest = line.substr(1);
  if (const std::size_t colon = rest.rfind(':'); colon != std::string_view::npos) {
    if (rest.substr(colon + 1) != zaber_check_sum(rest.substr(0, colon))) return std::nullopt;
    rest = rest.substr(0, colon);
  }
  ZaberReply reply;
  const std::string_view device = take_word(rest), axis = take_word(rest);
  std::string_view word = take_word(rest);
  if (!is_digits(device, 2) || !is_digits(axis, 1)) return std::nullopt;
  reply.device = *number_from<int>(device);
  reply.axis = *number_from<int>(axis);
  if (is_digits(word, 2)) {
    reply.message = number_from<int>(word);
    word = take_word(rest);
  }
  const std::string_view state = take_word(rest), warning = take_word(rest);
  if ((word != "OK" && word != "RJ") || (state != "IDLE" && state != "BUSY") || !is_warning(warning) || rest.empty())
    return std::nullopt;
  reply.accepted = word == "OK";
  reply.busy = state == "BUSY";
  reply.warning = warning;
  reply.data = rest;
  return reply;
}

std::string zaber_warning_words(const std::string& warning) {
  const std::string named = "warning " + warning + ": ";
  if (warning == "WR" || warning == "WH") return named + "it does not know where it is (its power was off?); home it";
  if (warning == "FS" || warning == "FB" || warning == "WS")
    return named + "its motor stalled; see that nothing blocks the platform, then home it";
  if (warning == "FD" || warning == "FO")
    return named + "its driver is switched off; switch its power off and on, then home it";
  if (warning == "WV" || warning == "FV") return named + "its supply voltage is wrong; check its power supply";
  if (warning == "WT") return named + "it is too hot; let it cool down";
  if (warning == "WM") return named + "the platform was turned by something else; home it";
  return named + "see the stage's manual, then home it";
}

std::string zaber_rejection_words(const std::string& reason) {
  if (reason == "BADDATA") return reason + ": the angle is beyond its limits; check limit.min and limit.max";
  if (reason == "BADCOMMAND" || reason == "BADMESSAGEID")
    return reason + ": it does not know the command; it needs Zaber firmware 6.06 or later";
  if (reason == "BADAXIS" || reason == "BADDEVICE")
    return reason + ": there is no such stage; check \"device\" and \"axis\" in the rig file";
  if (reason == "STATUSBUSY" || reason == "AGAIN" || reason == "FULL")
    return reason + ": it is busy; wait until it stands still";
  if (reason == "PARKED") return reason + ": it is parked; unpark it";
  return reason + ": see the stage's manual";
}

}  // namespace rig
