// The interface of a stepper motor's controller at the end of a line (GRBL, Zaber). Positions are in the controller's
// own whole steps.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace rig {

// The controller gave no usable answer for too long, although the line is alive.
struct NoReply : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The controller no longer knows where the platform is: it reports an alarm or was reset.
struct PositionLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// How the position becomes known: `home_switch`, a switch that the motor looks for, or `here`, the place where the
// platform stands after a person has turned it to its mark.
enum class HomeBy { here, home_switch };

enum class Motion { idle, moving, held };  // held: after stop(), until clear_stop()

struct MotionStatus {
  Motion motion = Motion::idle;
  std::int64_t steps = 0;  // counted from the controller's own zero
};

struct ControllerIdentity {
  std::string firmware;             // the name that the firmware gives itself
  double steps_per_deg = 0;         // as the controller is set up
  double speed_deg_s = 0;           // of its moves; a stop ends within 5 degrees (stopping.h)
  int reading_tolerance_steps = 0;  // by how much a reported position may be rounded
  bool count_lost = false;          // it reported an alarm since it was opened: its count says nothing
  int repeated = 0;                 // number of questions asked again because the answer was noise or missing
};

// After stop() nothing turns until clear_stop(): neither a move that is under way, nor one that another thread begins
// while the stop is written.
//
// Errors: Unplugged (byte_line.h), NoReply, PositionLost, and std::runtime_error for a refusal; each message says what
// was asked, what came back and what the person can do.
class MotionController {
 public:
  virtual ~MotionController() = default;
  virtual ControllerIdentity identity() = 0;
  virtual void start_home() = 0;  // begins homing, which has ended when status() is idle again
  // Begins a move to an absolute position (as MotionStatus::steps), or lets the one under way end there instead when it
  // lies ahead: a platform that turns does not slow down in between.
  virtual void start_move(std::int64_t steps) = 0;
  virtual MotionStatus status() = 0;
  virtual void stop() = 0;        // writes once and does not wait; from any thread, also during homing
  virtual void clear_stop() = 0;  // waits until the motor stands and allows moves again; PositionLost if it was homing
};

}  // namespace rig
