// What readers of text files share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace station {

// The text without blanks at its ends.
inline std::string trimmed(std::string_view text, std::string_view blanks = " \t\r\n") {
  const std::size_t first = text.find_first_not_of(blanks), last = text.find_last_not_of(blanks);
  return first == std::string_view::npos ? "" : std::string(text.substr(first, last - first + 1));
}

// The text with small letters for the capitals of ASCII.
inline std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

// "a, b, c"
inline std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

}  // namespace station
