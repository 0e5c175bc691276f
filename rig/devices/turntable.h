// The interface of the turning platform. Angles are in radians, positive counter-clockwise seen from above.
//
// A move that stop() ends throws; the platform then stands where it is, its position stays known, and it may be moved
// again. stop() and state() may be called from any thread while another one waits in home() or move_to(). Angles that
// are not finite or out of the device's range are refused before anything moves, and so is a move before home().
#pragma once

namespace rig {

enum class TurntableState { unknown_position, idle, moving, stopped };

// Errors: std::runtime_error whose message says what was asked, what came back and what the person can do.
class Turntable {
 public:
  virtual ~Turntable() = default;
  virtual void home() = 0;                     // makes the position known; angle 0 afterwards
  virtual void move_to(double angle_rad) = 0;  // returns when the platform stands still at the nearest step
  virtual void stop() = 0;                     // stops at once; from any thread, also the one that ctrl-C wakes
  virtual double angle_rad() = 0;  // as the device reads it; from any thread while it moves: what it read last
  virtual TurntableState state() = 0;
  // Takes an angle that somebody has measured for the one at which the platform stands now, in place of the reading.
  // Throws for a turntable that finds its home by itself: its reading cannot be set right.
  virtual void stands_at(double angle_rad);
};

}  // namespace rig
