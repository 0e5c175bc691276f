// Numbers as text.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>

namespace station {

std::string number_text(double value, int decimals);
std::string percent_text(double part);  // "12.3 %"
// "0.1, 0.2, 0.3"
std::string numbers_text(std::initializer_list<double> values, int decimals);
// The number in the fewest digits that are read as the same number again.
std::string shortest_text(double value);
// The finite number that the whole text is, in any computer's language; nothing for any other text.
std::optional<double> finite_number(const std::string& text);
// The text that printf makes, at most 255 characters.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

}  // namespace station
