#include "station/documents/disk/file_name.h"

#include <unicode/translit.h>
#include <unicode/unistr.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "station/documents/disk/shown_text.h"

namespace station {
namespace {

constexpr std::size_t kLongestName = 100;

bool allowed(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

bool is_device_of_windows(std::string_view name) {
  std::string stem(name.substr(0, name.find('.')));
  std::transform(stem.begin(), stem.end(), stem.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  constexpr std::array<std::string_view, 4> kDevices = {"CON", "PRN", "AUX", "NUL"};
  const bool numbered =
      stem.size() == 4 && (stem.starts_with("COM") || stem.starts_with("LPT")) && stem[3] >= '1' && stem[3] <= '9';
  return numbered || std::find(kDevices.begin(), kDevices.end(), stem) != kDevices.end();
}

std::string shown(std::string_view name) {
  return "'" + shown_text(name) + "'";
}

bool plain(UChar32 c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

// In ASCII letters as far as there are any for it.
icu::UnicodeString romanized(const std::string& text) {
  UErrorCode error = U_ZERO_ERROR;
  const std::unique_ptr<icu::Transliterator> to_ascii(
      icu::Transliterator::createInstance("NFC; Any-Latin; de-ASCII; Latin-ASCII", UTRANS_FORWARD, error));
  if (U_FAILURE(error))
    throw std::runtime_error(std::string("names cannot be written in Latin letters: ") + u_errorName(error) +
                             "; reinstall libicu");
  icu::UnicodeString letters = icu::UnicodeString::fromUTF8(text);
  to_ascii->transliterate(letters);
  return letters;
}

}  // namespace

std::optional<std::string> problem_with_name(std::string_view name) {
  if (name.empty()) return "a name is empty; give one of letters, digits and . _ -";
  if (name.size() > kLongestName) {
    return "the name " + shown(name) + " has " + std::to_string(name.size()) + " characters; use at most " +
           std::to_string(kLongestName);
  }
  if (!std::all_of(name.begin(), name.end(), allowed)) {
    return "the name " + shown(name) +
           " has a character that file names here may not have; use letters, digits and . _ -";
  }
  if (name.front() == '.' || name.front() == '-' || name.back() == '.' || name.find("..") != std::string_view::npos) {
    return "the name " + shown(name) +
           " begins with a dot or dash, ends with a dot or has two dots together; rename it";
  }
  if (is_device_of_windows(name)) return "the name " + shown(name) + " means a device on Windows; rename it";
  return std::nullopt;
}

std::string safe_name(const std::string& text) {
  constexpr UChar32 kFirstBeyondAscii = 128;
  const icu::UnicodeString letters = romanized(text);
  std::string name;
  for (std::int32_t at = 0; at < letters.length(); at = letters.moveIndex32(at, 1)) {
    const UChar32 code = letters.char32At(at);
    if (plain(code)) {
      name += static_cast<char>(code);
    } else if (code >= kFirstBeyondAscii) {
      char written[16];
      std::snprintf(written, sizeof written, "u%04x", static_cast<unsigned>(code));
      name += written;
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (name.ends_with('-')) name.pop_back();
  return name;
}

}  // namespace station
