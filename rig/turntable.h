// A motorised platform. Angles in radians, positive counter-clockwise seen from above.
#pragma once

namespace rig {

enum class TurntableState { unknown_position, idle, moving, stopped };

// Errors: std::runtime_error whose message says what was asked, what came back and what the person can do.
class Turntable {
 public:
  virtual ~Turntable() = default;
  virtual void home() = 0;                     // makes the position known; angle 0 afterwards
  virtual void move_to(double angle_rad) = 0;  // returns when the platform stands still at the nearest step
  virtual void stop() = 0;                     // at once, from any thread or signal handler's follow-up
  virtual double angle_rad() = 0;              // as the device reads it
  virtual TurntableState state() = 0;
};

}  // namespace rig
