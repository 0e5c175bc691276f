#include "tests/support/documented_settings.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace {

const std::map<int, double>& as_it_comes() {
  static const std::map<int, double> kSettings{
      {0, 10},     {1, 25},    {2, 0},    {3, 0},    {4, 0},     {5, 0},     {6, 0},     {10, 1},    {11, 0.01},
      {12, 0.002}, {13, 0},    {20, 0},   {21, 0},   {22, 0},    {23, 0},    {24, 25},   {25, 500},  {26, 250},
      {27, 1},     {30, 1000}, {31, 0},   {32, 0},   {100, 250}, {101, 250}, {102, 250}, {110, 500}, {111, 500},
      {112, 500},  {120, 10},  {121, 10}, {122, 10}, {130, 200}, {131, 200}, {132, 200}};
  return kSettings;
}

}  // namespace

std::string documented_text(const char* format, ...) {
  std::array<char, 256> buffer{};
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer.data(), buffer.size(), format, arguments);
  va_end(arguments);
  return buffer.data();
}

DocumentedSettings::DocumentedSettings(const std::map<int, double>& others) : values_(as_it_comes()) {
  for (const auto& [number, value] : others) values_[number] = value;
}

void DocumentedSettings::restore() {
  values_ = as_it_comes();
}

int DocumentedSettings::set(const std::string& line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string::npos || equals + 1 == line.size() || equals == 1) return 3;
  char *number_end = nullptr, *value_end = nullptr;
  const std::string name = line.substr(1, equals - 1), given = line.substr(equals + 1);
  const auto number = static_cast<int>(std::strtol(name.c_str(), &number_end, 10));
  const double value = std::strtod(given.c_str(), &value_end);
  if (*value_end != '\0') return 2;
  if (*number_end != '\0' || !values_.contains(number)) return 3;
  if (value < 0) return 4;
  if (number == 0 && value < 3) return 6;
  if (number == 20 && value != 0 && !is_on(22)) return 10;
  values_[number] = value;
  if (number == 22 && value == 0) values_[20] = 0;
  return 0;
}

std::vector<std::string> DocumentedSettings::lines() const {
  static constexpr std::array kWithDecimals{11, 12, 24, 25, 27};
  std::vector<std::string> lines;
  for (const auto& [number, value] : values_) {
    const bool decimals = number >= 100 || std::ranges::find(kWithDecimals, number) != kWithDecimals.end();
    lines.push_back(documented_text(decimals ? "$%d=%.3f" : "$%d=%.0f", number, value));
  }
  return lines;
}
