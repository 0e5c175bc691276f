// The parser of one line sent by GRBL 1.1 (or grblHAL, FluidNC). It is strict: a line that does not follow the grammar
// exactly is noise.
//
// Angles are in degrees of the firmware's first axis (the firmware calls them mm).
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
  // A report has either machine or work position; the offset (work = machine - offset) is in some reports only.
  std::optional<double> machine_deg, work_deg, work_offset_deg;
};
struct GrblSetting {
  int number = 0;
  double value = 0;
};
struct GrblMessage {
  std::string text;  // what stands between the brackets: "VER:1.1h.20190830:"
};
struct GrblNoise {
  std::string text;
};
using GrblReply =
    std::variant<GrblOk, GrblError, GrblAlarm, GrblBanner, GrblStatus, GrblSetting, GrblMessage, GrblNoise>;

// Reads one line. When a line end was lost, a status report is still found inside the line, because its brackets cannot
// be mistaken; an "ok" is taken only when it is the whole line.
GrblReply parse_grbl_line(std::string_view line);

// The words that tell the person at the turntable what an alarm or error means and what to do about it.
std::string grbl_alarm_words(int code);
std::string grbl_error_words(int code);

}  // namespace rig
