// The base of turntables whose device does not report its angle: the driver says where the platform came to, and any
// thread may ask for the angle or stop the platform meanwhile.
#pragma once

#include <atomic>
#include <string>

#include "rig/devices/turntable.h"

namespace rig {

// Its angles are within one whole turn either way.
class TrackedTurntable : public Turntable {
 public:
  void stop() final;
  double angle_rad() final;
  TurntableState state() final { return state_; }

 protected:
  // To be called before a move: throws std::runtime_error when the angle is not finite or out of range, or the position
  // is unknown.
  void require_reachable(double angle_rad) const;

  // A stop() by anybody who has seen the state `moving` is not lost: stop_asked() then stays true until the next move.
  void begin_moving();
  bool stop_asked() const { return stop_asked_; }
  void came_to(double angle_rad) { reading_rad_ = angle_rad; }
  void end_moving(TurntableState state) { state_ = state; }
  double reading_rad() const { return reading_rad_; }

 private:
  void require_known_position(const std::string& asked) const;

  std::atomic<TurntableState> state_ = TurntableState::unknown_position;
  std::atomic<double> reading_rad_ = 0.0;
  std::atomic<bool> stop_asked_ = false;
};

std::string degrees_text(double angle_rad);  // "30.0 deg"

}  // namespace rig
