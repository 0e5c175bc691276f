#include "rig/turntables/grbl_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "rig/turntables/stopping.h"

namespace rig {
namespace {

constexpr double kWrittenRatio = 1e-5;         // rounding of what the firmware prints with three decimals
constexpr double kTravelDeg = 360;             // 1.5 x $130 passes the switch even when it begins just behind it
constexpr int kHomingOn = 1, kSingleAxis = 2;  // bits of grblHAL's $22; other firmware has the first alone

// Collects the rows of those settings that the firmware has.
struct Rows {
  const GrblSettings& found;
  std::vector<GrblSettingRow> rows{};

  double at(int number) const { return found.contains(number) ? found.at(number) : 0; }
  void add(int number, const char* meaning, bool right, double needed, const std::string& expected) {
    if (!found.contains(number)) return;
    rows.push_back({.number = number,
                    .meaning = meaning,
                    .now = found.at(number),
                    .needed = right ? std::nullopt : std::optional(needed),
                    .expected = expected});
  }
  void add(int number, const char* meaning, double needed) {
    add(number, meaning, at(number) == needed, needed, grbl_number(needed));
  }
};

// The firmware ends a homing that is stopped without slowing down, and the platform's own weight takes it further.
void add_homing_speed(Rows& rows, int number, const char* meaning, double part_of_largest) {
  const double largest = grbl_stoppable_speed_deg_s(rows.found) * kSecondsPerMinute, now = rows.at(number);
  rows.add(number, meaning, now > 0 && now <= largest * (1 + kWrittenRatio), largest * part_of_largest,
           "above 0, at most " + grbl_number(largest) + ", to be stopped within 5 degrees");
}

void add_homing(Rows& rows, const GrblFirmware& firmware) {
  // A board that knows $HX only by this bit says so by its letter H as soon as the bit is set.
  const int bits = firmware.kind == GrblFirmware::Kind::grblhal ? kHomingOn | kSingleAxis : kHomingOn;
  const int now = static_cast<int>(rows.at(22));
  rows.add(22, "homing by the switch", (now & bits) == bits, now | bits,
           bits == kHomingOn ? "1" : "on, with single axes (" + std::to_string(bits) + ")");
  add_homing_speed(rows, 24, "speed at the home switch, degrees a minute", 0.1);
  add_homing_speed(rows, 25, "speed towards the home switch, degrees a minute", 1);
}

}  // namespace

GrblFirmware grbl_firmware(const std::string& banner, const std::vector<std::string>& lines) {
  GrblFirmware firmware{.kind = GrblFirmware::Kind::grbl, .name = banner};
  const auto says = [&](const std::string& words) {
    return banner.find(words) != std::string::npos ||
           std::ranges::any_of(lines, [&](const std::string& line) { return line.find(words) != std::string::npos; });
  };
  if (says("FluidNC")) firmware.kind = GrblFirmware::Kind::fluidnc;
  if (says("GrblHAL") || says("grblHAL")) firmware.kind = GrblFirmware::Kind::grblhal;
  for (const std::string& line : lines) {
    if (!line.starts_with("OPT:")) continue;
    const std::string letters = line.substr(4, line.find(',') - 4);
    firmware.homes_single_axis = letters.find('H') != std::string::npos;
  }
  if (firmware.kind == GrblFirmware::Kind::fluidnc) firmware.homes_single_axis = true;  // whatever its letters are
  return firmware;
}

std::vector<GrblSettingRow> grbl_setting_rows(const GrblSettings& found, const ControllerSetup& setup,
                                              const GrblFirmware& firmware) {
  Rows rows{.found = found};
  // In other firmware $1 means something else; its own manual says how to keep the motor powered.
  if (firmware.name.starts_with("Grbl 1.1")) rows.add(1, "the motor stays on between moves", 255);
  rows.add(13, "reports in inches", 0);
  rows.add(20, "soft limits, off because a platform turns endlessly", 0);
  const bool by_switch = setup.home_by == HomeBy::home_switch;
  if (by_switch) {
    rows.add(21, "alarm at the switch, off because the platform passes it", 0);
    add_homing(rows, firmware);
  }
  rows.add(32, "laser mode", 0);
  if (setup.steps_per_deg > 0)
    rows.add(100, "steps per degree", std::abs(rows.at(100) / setup.steps_per_deg - 1) <= kSameRatio,
             setup.steps_per_deg, grbl_number(setup.steps_per_deg));
  if (by_switch) {
    rows.add(130, "travel in degrees, over which the switch is looked for", rows.at(130) >= kTravelDeg, kTravelDeg,
             "at least " + grbl_number(kTravelDeg));
  }
  return rows.rows;
}

double grbl_stoppable_speed_deg_s(const GrblSettings& found) {
  const auto fastest = found.find(110), acceleration = found.find(120);
  const bool known = acceleration != found.end() && acceleration->second > 0;
  const double speed_deg_s = known ? stoppable_speed_deg_s(acceleration->second) : kSureSpeedDegS;
  const bool limited = fastest != found.end() && fastest->second > 0;
  return limited ? std::min(speed_deg_s, fastest->second / kSecondsPerMinute) : speed_deg_s;
}

std::optional<std::string> grbl_homing_command(const ControllerSetup& setup, const GrblFirmware& firmware) {
  // GRBL that was built without $HX refuses it and stays in its homing state, so it is never tried.
  if (firmware.homes_single_axis || firmware.kind == GrblFirmware::Kind::grblhal) return "$HX";
  if (setup.homes_x_alone) return "$H";
  return std::nullopt;
}

std::string grbl_homing_problem() {
  return "this firmware homes Z first, as it comes, and a turntable has no Z: flash it with \"#define HOMING_CYCLE_0 "
         "(1<<X_AXIS)\" and HOMING_SINGLE_AXIS_COMMANDS (config.h), or write \"homing_cycle\": \"x_only\" in the rig "
         "file if it was changed to home X alone, or \"home\": \"here\" to put the mark to the front by hand";
}

void require_grbl_settings(const GrblSettings& found, const ControllerSetup& setup, const GrblFirmware& firmware) {
  std::string differ, lines;
  for (const GrblSettingRow& row : grbl_setting_rows(found, setup, firmware)) {
    if (!row.needed) continue;
    differ += (differ.empty() ? "" : "; ") + grbl_setting_line(row.number, row.now) + " (" + row.meaning + ": " +
              row.expected + (row.number == 100 ? " in the rig file" : "") + ")";
    lines += (lines.empty() ? "" : ", ") + grbl_setting_line(row.number, *row.needed);
  }
  std::string problem;
  if (!differ.empty()) {
    problem = "the turntable's controller is set up otherwise than the rig needs: " + differ + "; " +
              (firmware.kind == GrblFirmware::Kind::fluidnc
                   ? "change its configuration file (config.yaml) to what would be: " + lines
                   : "type: " + lines + ", or let \"threadstation turntable set-up\" write them") +
              " ($100 and the rig file: steps per turn x microsteps x gear / 360)";
  }
  if (setup.home_by == HomeBy::home_switch && !grbl_homing_command(setup, firmware))
    problem += (problem.empty() ? "the turntable cannot look for its home switch: " : "; and ") + grbl_homing_problem();
  if (!problem.empty()) throw std::runtime_error(problem);
}

std::string grbl_number(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f", value);
  std::string number = text.data();
  number.erase(number.find_last_not_of('0') + 1);
  if (number.ends_with('.')) number.pop_back();
  return number;
}

std::string grbl_setting_line(int number, double value) {
  return "$" + std::to_string(number) + "=" + grbl_number(value);
}

}  // namespace rig
