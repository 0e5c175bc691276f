// A turntable whose driver keeps account of where the platform stands, because nothing else does: what moves it says where
// it came to, and anybody may ask or stop it meanwhile.
#pragma once

#include <atomic>
#include <string>

#include "rig/turntable.h"

namespace rig {

// One whole turn either way.
class TrackedTurntable : public Turntable {
 public:
  void stop() final;
  double angle_rad() final;
  TurntableState state() final { return state_; }

 protected:
  // Before a move: refuses what is no angle or out of range, and any angle while the position is unknown.
  void require_reachable(double angle_rad) const;

  // Whoever sees the platform moving and stops it is heard.
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
