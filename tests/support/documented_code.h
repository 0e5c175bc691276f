// G-code as the documented GRBL (documented_grbl.h) reads it: one line, its errors, and the modes that it leaves.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>

// The modes that a reset makes those of their defaults.
inline constexpr double kMmPerInch = 25.4;

struct DocumentedModes {
  int motion = 0;  // G0, G1; 80: none
  bool incremental = false, inches = false;
  int system = 54;
  double feed = 0;  // units per minute, in mm
};

struct DocumentedCode {
  enum class Kind { nothing, move, dwell, offset, no_offset };
  Kind kind = Kind::nothing;
  std::array<std::optional<double>, 3> axes;  // mm
  bool rapid = false, incremental = false, machine = false;
  double feed = 0;
  double dwell_s = 0;
};

// The code in a line without blanks, in capitals, or the number of its error. `modes` changes when there is none; by a
// jog never.
std::variant<DocumentedCode, int> read_documented_code(const std::string& line, bool jog, DocumentedModes& modes);
