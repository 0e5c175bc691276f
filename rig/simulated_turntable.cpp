#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "rig/simulated_bench.h"

namespace rig {
namespace {

constexpr double kLimitRad = 2 * std::numbers::pi * (1 + 1e-9);  // one whole turn either way
constexpr double kSliceS = 0.02;                                 // a stop is seen within this time

std::string degrees(double angle_rad) {
  return std::to_string(angle_rad * 180 / std::numbers::pi) + " deg";
}

// Only the thread that moves touches the bench; stop(), state() and angle_rad() may come from others.
class SimulatedTurntable final : public Turntable {
 public:
  SimulatedTurntable(SimulatedBench& bench, Clock& clock) : bench_(bench), clock_(clock) {}

  void home() override {
    const double from_rad = bench_.state().platform_angle_rad / truth().scale;
    begin_moving();
    if (!travel(from_rad, 0.0)) {
      state_ = TurntableState::unknown_position;
      throw std::runtime_error("the platform was stopped while it looked for its home; home it again");
    }
    state_ = TurntableState::idle;
  }

  void move_to(double wanted_rad) override {
    if (!std::isfinite(wanted_rad) || std::abs(wanted_rad) > kLimitRad) {
      throw std::runtime_error("the platform was asked to turn to " + degrees(wanted_rad) +
                               "; it turns between -360 and 360 deg");
    }
    require_known_position("turn to " + degrees(wanted_rad));
    const double target_rad = nearest_step(wanted_rad);
    begin_moving();
    const bool arrived = travel(reading_rad_, target_rad);
    state_ = arrived ? TurntableState::idle : TurntableState::stopped;
    if (!arrived) {
      throw std::runtime_error("the platform was stopped at " + degrees(reading_rad_) + " on its way to " +
                               degrees(target_rad) + "; ask for the move again when it is safe");
    }
  }

  void stop() override {
    stop_asked_ = true;
    auto standing = TurntableState::idle;  // a moving platform tells itself, an unknown position stays unknown
    state_.compare_exchange_strong(standing, TurntableState::stopped);
  }

  double angle_rad() override {
    require_known_position("tell its angle");
    return reading_rad_;
  }

  TurntableState state() override { return state_; }

 private:
  const TrueTurntable& truth() const { return bench_.truth().turntable; }

  void require_known_position(const std::string& asked) const {
    if (state_ == TurntableState::unknown_position) {
      throw std::runtime_error("the platform was asked to " + asked + ", but its position is unknown; home it first");
    }
  }

  double nearest_step(double angle_rad) const {
    const double step_rad = truth().step_rad;
    return step_rad > 0 ? std::round(angle_rad / step_rad) * step_rad : angle_rad;
  }

  void stand_at(double reading_rad) {
    reading_rad_ = reading_rad;
    bench_.turn_platform(truth().scale * reading_rad);
  }

  // In this order: whoever sees the platform moving and stops it must be heard.
  void begin_moving() {
    stop_asked_ = false;
    state_ = TurntableState::moving;
  }

  // Turns in slices of time; false when it was stopped on the way.
  bool travel(double from_rad, double to_rad) {
    const double duration_s = std::abs(to_rad - from_rad) / truth().speed_rad_s;
    for (double done_s = 0; done_s < duration_s;) {
      const double slice_s = std::min(kSliceS, duration_s - done_s);
      clock_.sleep_s(slice_s);
      done_s += slice_s;
      stand_at(nearest_step(from_rad + (to_rad - from_rad) * (done_s / duration_s)));
      if (stop_asked_) {
        return false;
      }
    }
    stand_at(to_rad);
    return true;
  }

  SimulatedBench& bench_;
  Clock& clock_;
  std::atomic<TurntableState> state_ = TurntableState::unknown_position;
  std::atomic<double> reading_rad_ = 0.0;
  std::atomic<bool> stop_asked_ = false;
};

}  // namespace

std::unique_ptr<Turntable> make_simulated_turntable(SimulatedBench& bench, Clock& clock) {
  return std::make_unique<SimulatedTurntable>(bench, clock);
}

}  // namespace rig
