#include "rig/devices/clock.h"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <thread>

namespace rig {
namespace {

std::string utc_from_unix_ms(long long unix_ms) {
  const auto seconds = static_cast<std::time_t>(unix_ms / 1000);
  std::tm date{};
  gmtime_r(&seconds, &date);
  std::array<char, 32> day{};
  std::strftime(day.data(), day.size(), "%Y-%m-%dT%H:%M:%S", &date);
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%s.%03dZ", day.data(), static_cast<int>(unix_ms % 1000));
  return text.data();
}

}  // namespace

double SystemClock::monotonic_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string SystemClock::utc() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return utc_from_unix_ms(std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
}

void SystemClock::sleep_s(double duration_s) {
  std::this_thread::sleep_for(std::chrono::duration<double>(duration_s));
}

void SimulatedClock::sleep_s(double duration_s) {
  if (pace_ > 0) std::this_thread::sleep_for(std::chrono::duration<double>(duration_s * pace_));
  elapsed_s_ += duration_s;
}

std::string SimulatedClock::utc() {
  return utc_from_unix_ms(std::llround((utc_start_unix_s_ + elapsed_s_) * 1000));
}

}  // namespace rig
