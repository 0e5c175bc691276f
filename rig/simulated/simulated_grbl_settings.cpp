#include "rig/simulated/simulated_grbl_settings.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "rig/turntables/grbl_code.h"
#include "rig/turntables/reply_text.h"
#include "rig/turntables/stopping.h"

namespace rig {

SimulatedGrblSettings::SimulatedGrblSettings(const SimulatedMotor& motor, bool with_switch)
    : with_switch_(with_switch) {
  const double deg_min = motor.full_speed_deg_s() * 60;
  values_ = {{0, 10},
             {1, 255},
             {2, 0},
             {3, 0},
             {4, 0},
             {5, 0},
             {6, 0},
             {10, 1},
             {11, 0.01},
             {12, 0.002},
             {13, 0},
             {20, 0},
             {21, 0},
             {22, with_switch ? 1.0 : 0.0},
             {23, 0},
             {24, deg_min / 10},
             {25, std::min(deg_min, 60 * stoppable_speed_deg_s(motor.acceleration_deg_s2()))},
             {26, 250},
             {27, 2},
             {30, 1000},
             {31, 0},
             {32, 0},
             {100, motor.steps_per_deg()},
             {101, 250},
             {102, 250},
             {110, deg_min},
             {111, 500},
             {112, 500},
             {120, motor.acceleration_deg_s2()},
             {121, 10},
             {122, 10},
             {130, 360},
             {131, 200},
             {132, 200}};
}

int SimulatedGrblSettings::set(const std::string& line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string::npos) return kUnknownStatement;
  const auto number = number_from<int>(std::string_view(line).substr(1, equals - 1));
  const auto value = number_from<double>(std::string_view(line).substr(equals + 1));
  if (!number || !value) return kBadNumber;
  if (*value < 0) return kNegativeValue;
  if (!values_.contains(*number)) return kUnknownStatement;
  if (*number == 20 && *value != 0 && at(22) == 0) return kSoftLimitsNeedHoming;
  values_[*number] = *value;
  return 0;
}

std::vector<std::string> SimulatedGrblSettings::lines() const {
  std::vector<std::string> lines;
  for (const auto& [number, value] : values_) {
    const bool decimals = number == 11 || number == 12 || number == 24 || number == 25 || number == 27 ||
                          number == 30 || number == 31 || number >= 100;
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), decimals ? "$%d=%.3f" : "$%d=%.0f", number, value);
    lines.emplace_back(text.data());
  }
  return lines;
}

std::string SimulatedGrblSettings::options() const {
  return homes_single_axis() ? "VH,15,128" : "V,15,128";
}

}  // namespace rig
