// A turntable driven by a stepper motor: it turns angles in radians into a controller's whole steps and watches the
// moves.
//
// An angle that is not finite or out of limits is refused before anything is sent. The platform stands at the nearest
// whole step, which angle_rad() reads back. No place counts that the controller has not reported twice in a row. A move
// is sent in pieces, the next one while the platform turns, so that the motor never has more than a second's way before
// it: a program that is killed leaves a platform that stops by itself. A piece that got lost is repeated, three times
// at most. With backlash, every position is approached by turning counter-clockwise. After silence, an alarm or a reset
// the position is unknown, and home() connects anew; with `HomeBy::here` the platform is turned back from where its
// memory says that it was left.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "rig/devices/clock.h"
#include "rig/devices/turntable.h"
#include "rig/turntables/motion_controller.h"

namespace rig {

// Where the platform stands, for the program that comes after this one.
struct PlatformPlace {
  std::int64_t steps = 0;  // in the controller's count, which begins at 0 when its board is reset
  double angle_rad = 0;
  bool turning = false;  // a move was begun there and its end was not written
  bool lost = false;     // nobody knows where it stands
};

// What a turntable without a home switch knows from one program to the next.
class PlatformMemory {
 public:
  virtual ~PlatformMemory() = default;
  virtual std::optional<PlatformPlace> recall() = 0;  // nothing: there was no program before
  virtual void keep(const PlatformPlace& place) = 0;
  // Has somebody turn the platform to its mark, because nobody knows where it stands; false: there is nobody.
  virtual bool ask_for_mark(const std::string& why) = 0;
};

struct StepperSetup {
  HomeBy home_by = HomeBy::here;
  double limit_rad = 2 * std::numbers::pi;  // largest angle either way: one turn
  double backlash_rad = 0;
  double move_timeout_s = 120;  // for one move or one homing
  double stall_timeout_s = 3;   // for a move during which the reading does not change
  // For HomeBy::here; without one the platform is believed to stand at its mark.
  std::shared_ptr<PlatformMemory> memory{};
};

// Opens the line and connects to the controller. It is called again after the controller was lost; the port may then
// have another name.
using ConnectController = std::function<std::shared_ptr<MotionController>()>;

// A turntable that has called `connect`. The clock must outlive it. Errors: those of `connect`.
std::unique_ptr<Turntable> make_stepper_turntable(ConnectController connect, Clock& clock, const StepperSetup& setup);

}  // namespace rig
