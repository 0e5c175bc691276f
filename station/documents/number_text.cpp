#include "station/documents/number_text.h"

#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace station {

std::string number_text(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string percent_text(double part) {
  return number_text(100 * part, 1) + " %";
}

std::string numbers_text(std::initializer_list<double> values, int decimals) {
  std::string text;
  for (double value : values) text += (text.empty() ? "" : ", ") + number_text(value, decimals);
  return text;
}

std::string shortest_text(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string formatted(const char* format, ...) {
  char text[256];
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  return text;
}

std::optional<double> finite_number(const std::string& text) {
  double value = 0;
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace station
