#include "station/bench/calibrate/calibration_step.h"

#include <array>
#include <stdexcept>

namespace station {
namespace {

constexpr std::array<const char*, 9> kRoleWords{"lens",  "turning", "front_light", "back_light", "response",
                                                "rapid", "dark",    "white_field", "colour"};

}  // namespace

std::string to_text(CalibrationRole role) {
  return kRoleWords.at(static_cast<std::size_t>(role));
}

std::string part_of(CalibrationRole role) {
  switch (role) {
    case CalibrationRole::lens:
      return "camera";
    case CalibrationRole::turning:
      return "platform";
    case CalibrationRole::front_light:
    case CalibrationRole::back_light:
      return "light";
    case CalibrationRole::response:
    case CalibrationRole::rapid:
    case CalibrationRole::dark:
    case CalibrationRole::white_field:
    case CalibrationRole::colour:
      return "response";
  }
  throw std::logic_error("a role of no part");
}

CalibrationRole calibration_role(const std::string& text) {
  for (std::size_t i = 0; i < kRoleWords.size(); ++i)
    if (text == kRoleWords[i]) return static_cast<CalibrationRole>(i);
  throw std::runtime_error("unknown calibration role \"" + text + "\"");
}

}  // namespace station
