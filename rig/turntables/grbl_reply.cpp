#include "rig/turntables/grbl_reply.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "rig/turntables/reply_text.h"

namespace rig {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

std::optional<GrblState> state_from(std::string_view word) {
  static constexpr std::array<std::pair<std::string_view, GrblState>, 16> kStates{{{"Idle", GrblState::idle},
                                                                                   {"Run", GrblState::run},
                                                                                   {"Hold:0", GrblState::hold},
                                                                                   {"Hold:1", GrblState::hold_moving},
                                                                                   {"Jog", GrblState::jog},
                                                                                   {"Alarm", GrblState::alarm},
                                                                                   {"Door:0", GrblState::door},
                                                                                   {"Door:1", GrblState::door},
                                                                                   {"Door:2", GrblState::door},
                                                                                   {"Door:3", GrblState::door},
                                                                                   {"Door", GrblState::door},
                                                                                   {"Check", GrblState::check},
                                                                                   {"Home", GrblState::home},
                                                                                   {"Sleep", GrblState::sleep},
                                                                                   {"Tool", GrblState::door},
                                                                                   {"Cycle", GrblState::run}}};
  if (word.starts_with("Alarm:") && number_from<int>(word.substr(6))) return GrblState::alarm;  // grblHAL adds the code
  const auto found = std::ranges::find(kStates, word, [](const auto& entry) { return entry.first; });
  return found == kStates.end() ? std::nullopt : std::optional(found->second);
}

// The first axis of "40.000,0.000,0.000". Each number must have exactly three decimals, so that a lost character shows.
std::optional<double> first_axis(std::string_view text) {
  const std::vector<std::string_view> axes = split(text, ',');
  std::optional<double> first;
  for (const std::string_view axis : axes) {
    const std::size_t point = axis.find('.');
    const auto value = number_from<double>(axis);
    if (!value || point == std::string_view::npos || axis.size() - point != 4 || axes.size() < 3) return std::nullopt;
    first = first ? first : value;
  }
  return first;
}

// Reads a status report from the text between < and >.
std::optional<GrblStatus> status_from(std::string_view inside) {
  const std::vector<std::string_view> fields = split(inside, '|');
  const auto state = state_from(fields.front());
  if (!state) return std::nullopt;
  GrblStatus status{.state = *state, .machine_deg = {}, .work_deg = {}, .work_offset_deg = {}};
  const std::array<std::pair<std::string_view, std::optional<double>*>, 3> positions{
      {{"MPos:", &status.machine_deg}, {"WPos:", &status.work_deg}, {"WCO:", &status.work_offset_deg}}};
  for (const std::string_view field : fields) {
    for (const auto& [name, value] : positions) {
      if (field.starts_with(name)) {
        *value = first_axis(field.substr(name.size()));
        if (!*value) return std::nullopt;
      }
    }
  }
  if (status.machine_deg.has_value() == status.work_deg.has_value()) return std::nullopt;
  return status;
}

std::optional<GrblSetting> setting_from(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (!line.starts_with('$') || equals == std::string_view::npos) return std::nullopt;
  const auto number = number_from<int>(line.substr(1, equals - 1));
  // grblHAL and verbose builds of GRBL add words in brackets behind a blank.
  std::string_view text = line.substr(equals + 1);
  text = text.substr(0, text.find(' '));
  const auto value = number_from<double>(text);
  if (!number || *number < 0 || !value) return std::nullopt;
  return GrblSetting{*number, *value};
}

}  // namespace

GrblReply parse_grbl_line(std::string_view line) {
  const std::size_t open = line.rfind('<');
  if (open != std::string_view::npos) {
    const std::size_t close = line.find('>', open);
    if (close != std::string_view::npos) {
      if (const auto status = status_from(line.substr(open + 1, close - open - 1))) return *status;
    }
    return GrblNoise{std::string(line)};
  }
  if (line == "ok") return GrblOk{};
  if (line.starts_with("error:") && is_plain(line)) {
    const std::string_view rest = line.substr(6);
    return GrblError{number_from<int>(rest).value_or(0), std::string(rest)};
  }
  if (line.starts_with("ALARM:")) {
    if (const auto code = number_from<int>(line.substr(6)); code && *code > 0) return GrblAlarm{*code};
  }
  if ((line.starts_with("Grbl ") || line.starts_with("GrblHAL ")) && line.ends_with(']') && is_plain(line))
    return GrblBanner{std::string(line)};
  if (line.starts_with('[') && line.ends_with(']') && is_plain(line))
    return GrblMessage{std::string(line.substr(1, line.size() - 2))};
  if (const auto setting = setting_from(line)) return *setting;
  return GrblNoise{std::string(line)};
}

std::string grbl_alarm_words(int code) {
  const std::string alarm = "alarm " + std::to_string(code) + ": ";
  switch (code) {
    case 1:
      return alarm + "it ran into its end switch; free the platform and see that nothing touches the switch";
    case 2:
      return alarm + "a move went beyond its soft limits; switch these off ($20=0), a platform turns endlessly";
    case 3:
      return alarm + "it was reset while it turned, steps may be lost";
    case 4:
    case 5:
      return alarm + "a probe did not answer as expected; unplug what is connected to the probe input";
    case 6:
      return alarm + "its homing was ended by a reset";
    case 7:
      return alarm + "its homing was ended by the safety door input; close it";
    case 8:
      return alarm + "its home switch stays pressed; free the switch, or make the pull-off ($27) longer";
    case 9:
      return alarm + "it found no home switch; check the switch and its cable";
    case 10:
      return alarm + "the emergency button is pressed; release it";
    default:
      return alarm + "see the controller's manual";
  }
}

std::string grbl_error_words(int code) {
  const std::string error = "error " + std::to_string(code) + ": ";
  switch (code) {
    case 1:
    case 2:
    case 3:
    case 20:
      return error + "it did not understand the command; check the cable (keep it short, away from the motor's)";
    case 5:
      return error + "homing is not enabled; set $22=1, or \"home\": \"here\" in the rig file";
    case 8:
      return error + "it is busy; wait until it stands still";
    case 9:
      return error + "it is locked by an alarm; home it";
    case 10:
      return error + "soft limits need homing; switch them off ($20=0)";
    case 15:
      return error + "the angle is beyond its limits; set $130 to 360 or more";
    case 22:
      return error + "the speed is missing";
    case 33:
      return error + "the angle is not one that it can reach";
    default:
      return error + "see the controller's manual";
  }
}

}  // namespace rig
