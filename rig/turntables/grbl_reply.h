// One line that GRBL 1.1 (or grblHAL, FluidNC) sends, read strictly: what is not exactly of the grammar is noise.
//
// Angles are in the firmware's own unit, degrees of its first axis (it calls them mm).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace rig {

enum class GrblState { idle, run, hold_moving, hold, jog, alarm, door, check, home, sleep };

struct GrblOk {};
struct GrblError {
  int code = 0;  // 0: an error in words, see `text`
  std::string text;
};
struct GrblAlarm {
  int code = 0;
};
struct GrblBanner {
  std::string text;
};
struct GrblStatus {
  GrblState state = GrblState::idle;
  std::optional<double> machine_deg, work_deg, work_offset_deg;  // one of the first two; the third now and then
};
struct GrblSetting {
  int number = 0;
  double value = 0;
};
struct GrblMessage {
  std::string text;  // between the brackets: "VER:1.1h.20190830:"
};
struct GrblNoise {
  std::string text;
};
using GrblReply =
    std::variant<GrblOk, GrblError, GrblAlarm, GrblBanner, GrblStatus, GrblSetting, GrblMessage, GrblNoise>;

// A status report is found inside a line too, because its brackets are unmistakable when a line end was lost; an "ok" never.
GrblReply parse_grbl_line(std::string_view line);

// What an alarm or error means to the person at the turntable, and what to do about it.
std::string grbl_alarm_words(int code);
std::string grbl_error_words(int code);

}  // namespace rig
