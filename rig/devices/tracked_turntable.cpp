#include "rig/devices/tracked_turntable.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "rig/devices/degree.h"

namespace rig {
namespace {

constexpr double kLimitRad = 2 * std::numbers::pi * (1 + 1e-9);

}  // namespace

std::string degrees_text(double angle_rad) {
  std::array<char, 400> text{};  // long enough for a double, which may have 309 digits before the point
  std::snprintf(text.data(), text.size(), "%.1f deg", angle_rad / kDegree);
  return text.data();
}

void TrackedTurntable::require_reachable(double angle_rad) const {
  if (!std::isfinite(angle_rad) || std::abs(angle_rad) > kLimitRad) {
    throw std::runtime_error("the platform was asked to turn to " + degrees_text(angle_rad) +
                             "; it turns between -360 and 360 deg");
  }
  require_known_position("turn to " + degrees_text(angle_rad));
}

void TrackedTurntable::require_known_position(const std::string& asked) const {
  if (state_ == TurntableState::unknown_position)
    throw std::runtime_error("the platform was asked to " + asked + ", but its position is unknown; home it first");
}

// The order matters: a stop() that comes between the two lines is not forgotten.
void TrackedTurntable::begin_moving() {
  stop_asked_ = false;
  state_ = TurntableState::moving;
}

void TrackedTurntable::stop() {
  stop_asked_ = true;
  auto standing = TurntableState::idle;  // while it moves, the moving thread sets `stopped`; unknown stays unknown
  state_.compare_exchange_strong(standing, TurntableState::stopped);
}

double TrackedTurntable::angle_rad() {
  require_known_position("tell its angle");
  return reading_rad_;
}

}  // namespace rig
