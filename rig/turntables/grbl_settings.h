// The settings that a GRBL turntable's controller needs ("$100=40"), held against those that it has, and how the
// firmware homes one axis alone.
//
// Settings that differ are said all at once, before anything turns: most of them end otherwise in an alarm that names
// a part which is not broken. GRBL looks for the home switch over 1.5 x $130, and homes Z first as it comes, an axis
// that a turntable does not have: both end in "alarm 9", that there is no home switch.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig/devices/clock.h"
#include "rig/turntables/byte_line.h"
#include "rig/turntables/controllers.h"

namespace rig {

inline constexpr double kSecondsPerMinute = 60;  // GRBL's speeds are per minute

using GrblSettings = std::map<int, double>;  // values by number: 100 for $100

struct GrblFirmware {
  enum class Kind { grbl, grblhal, fluidnc };
  Kind kind = Kind::grbl;
  std::string name;                // the name that it gives itself
  bool homes_single_axis = false;  // it knows $HX
};

// The firmware that begins with `banner` and answers $I with `lines`, without their brackets ("OPT:VH,15,128").
GrblFirmware grbl_firmware(const std::string& banner, const std::vector<std::string>& lines);

struct GrblSettingRow {
  int number = 0;
  std::string meaning;  // "steps per degree"
  double now = 0;
  std::optional<double> needed;  // the value to set; nothing: the present one is right
  std::string expected;          // "40", "1 ... 9000": what is right, in words
};

// The settings that the rig file has a say in, of those that the firmware has, in the order of their numbers.
std::vector<GrblSettingRow> grbl_setting_rows(const GrblSettings& found, const ControllerSetup& setup,
                                              const GrblFirmware& firmware);

// The speed from which a stop ends in time (stopping.h), by the controller's own limits of speed ($110, deg/min) and
// acceleration ($120, deg/s^2).
double grbl_stoppable_speed_deg_s(const GrblSettings& found);

// The command that homes the platform, "$HX" or "$H"; nothing when no command homes it without the other axes.
std::optional<std::string> grbl_homing_command(const ControllerSetup& setup, const GrblFirmware& firmware);

// What to do about a firmware that has no such command, one sentence.
std::string grbl_homing_problem();

// Throws std::runtime_error, one line, that names every setting that differs with what to type, and what is wrong with
// the homing.
void require_grbl_settings(const GrblSettings& found, const ControllerSetup& setup, const GrblFirmware& firmware);

std::string grbl_number(double value);                    // as it is typed: "40", "0.5", at most three decimals
std::string grbl_setting_line(int number, double value);  // "$100=40"

// A controller whose settings may be wrong: they are read and written, nothing turns. Errors: those of
// MotionController.
class GrblSettingsPort {
 public:
  virtual ~GrblSettingsPort() = default;
  virtual GrblFirmware firmware() = 0;
  virtual GrblSettings read_settings() = 0;
  virtual void write_setting(int number, double value) = 0;
};
std::unique_ptr<GrblSettingsPort> connect_grbl_settings(std::shared_ptr<ByteLine> line, Clock& clock,
                                                        const ControllerSetup& setup);

}  // namespace rig
