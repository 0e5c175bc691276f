// A stepper motor's controller at the end of a line, in its own whole steps: what GRBL and Zaber have in common.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace rig {

// The controller was asked and said nothing of use for too long. The line itself is alive.
struct NoReply : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The controller says, or shows, that it no longer knows where the platform is: alarm, reset.
struct PositionLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// How the position becomes known: a switch that the motor looks for, or the place where the platform stands, which a
// person has turned to its mark.
enum class HomeBy { here, home_switch };

enum class Motion { idle, moving, held };  // held: stopped, and not cleared since

struct MotionStatus {
  Motion motion = Motion::idle;
  std::int64_t steps = 0;  // from the controller's own zero
};

struct ControllerIdentity {
  std::string firmware;             // as it names itself
  double steps_per_deg = 0;         // as it is set up
  int reading_tolerance_steps = 0;  // what it reports may be off by so many
  int repeated = 0;                 // questions asked again because the answer was noise or missing
};

// After stop() nothing turns until clear_stop(): not what is under way, and not what is begun meanwhile. What one thread
// begins while another one stops is therefore never obeyed after the stop.
//
// Errors: Unplugged (byte_line.h), NoReply, PositionLost, and std::runtime_error for a refusal; each message says what
// was asked, what came back and what the person can do.
class MotionController {
 public:
  virtual ~MotionController() = default;
  virtual ControllerIdentity identity() = 0;
  virtual void start_home() = 0;                    // begins; idle again in status() when it is done
  virtual void start_move(std::int64_t steps) = 0;  // begins; absolute, as MotionStatus counts
  virtual MotionStatus status() = 0;
  virtual void stop() = 0;        // one write, from any thread; also while a homing runs
  virtual void clear_stop() = 0;  // waits until the motor stands; it can be moved again; PositionLost after a homing
};

}  // namespace rig
