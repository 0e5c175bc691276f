// The parser of G-code lines for the simulated GRBL 1.1 firmware: one axis, X, in degrees.
#pragma once

#include <optional>
#include <string>
#include <variant>

namespace rig {

// GRBL's status codes, as in its answer "error:9".
enum GrblStatusCode {
  kExpectedLetter = 1,
  kBadNumber = 2,
  kUnknownStatement = 3,
  kNegativeValue = 4,
  kHomingDisabled = 5,
  kNotIdle = 8,
  kLocked = 9,
  kSoftLimitsNeedHoming = 10,
  kLineTooLong = 14,
  kUnknownCode = 20,
  kNoFeed = 22,
  kAxisMissing = 26
};

// The modal state that one line leaves to the next ones.
struct GrblModes {
  bool incremental = false, rapid = true;
  double feed_deg_min = 0;
};

struct GrblCode {
  bool moves = false, rapid = false, incremental = false, machine = false;
  bool sets_offset = false;       // G92
  std::optional<double> dwell_s;  // G4
  std::optional<double> x_deg;
  double feed_deg_min = 0;
};

// The parsed line, or the status code of its error. Updates `modes`; the line of a jog leaves distance mode and feed as
// they were.
std::variant<GrblCode, GrblStatusCode> parse_grbl_code(const std::string& line, bool jog, GrblModes& modes);

}  // namespace rig
