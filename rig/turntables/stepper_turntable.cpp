#include "rig/turntables/stepper_turntable.h"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "rig/devices/degree.h"

namespace rig {
namespace {
constexpr double kPollS = 0.05;
constexpr int kMostTries = 4;     // of a move: begun once and repeated three times
constexpr int kIdleReadings = 2;  // so many in a row at the target: the platform has arrived
constexpr int kLostReadings = 6;  // so many in a row elsewhere: the command was lost
constexpr const char* kStoppedHoming = "the platform was stopped while it looked for its home; home it again";
constexpr double kLargestSteps = 1 << 24;  // GRBL counts in single precision, 24 bits

std::string degrees(double angle_rad) {
  return std::to_string(angle_rad / kDegree) + " deg";
}

// stop() and state() may be called from any thread, everything else from one.
class StepperTurntable final : public Turntable {
 public:
  StepperTurntable(ConnectController connect, Clock& clock, const StepperSetup& setup)
      : connect_(std::move(connect)), clock_(clock), setup_(setup) {
    reconnect();
  }

  void home() override {
    const bool known = state_ != TurntableState::unknown_position;
    if (lost_ || (!known && stop_asked_)) {  // connecting clears the stop
      stop_asked_ = false;
      reconnect();
      if (stop_asked_)  // stop() came while there was no controller that it could tell
        throw std::runtime_error("the platform was stopped while its controller was looked for; home it again");
    }
    guarded([&] {
      begin_moving();
      if (known && setup_.home_by == HomeBy::here) {
        approach(zero_steps_);
        return;
      }
      controller()->start_home();
      zero_steps_ = wait_until_idle();
    });
  }

  void move_to(double wanted_rad) override {
    if (!std::isfinite(wanted_rad) || std::abs(wanted_rad) > setup_.limit_rad * (1 + 1e-9)) {
      throw std::runtime_error("the platform was asked to turn to " + degrees(wanted_rad) + "; it turns between " +
                               degrees(-setup_.limit_rad) + " and " + degrees(setup_.limit_rad));
    }
    require_known_position("turn to " + degrees(wanted_rad));
    const double steps = std::round(wanted_rad * steps_per_rad_);
    if (std::abs(static_cast<double>(zero_steps_) + steps) > kLargestSteps) {
      throw std::runtime_error("the platform was asked to turn to " + degrees(wanted_rad) +
                               ", more steps from the controller's zero than it can count; home it again");
    }
    guarded([&] {
      begin_moving();
      approach(zero_steps_ + static_cast<std::int64_t>(steps));
    });
  }

  void stop() override {
    stop_asked_ = true;
    if (const auto found = controller()) found->stop();
    auto standing = TurntableState::idle;  // while it moves, the moving thread sets `stopped`; unknown stays unknown
    state_.compare_exchange_strong(standing, TurntableState::stopped);
  }

  double angle_rad() override {
    require_known_position("tell its angle");
    double angle_rad = 0;
    const TurntableState before = state_;
    guarded([&] {
      angle_rad = static_cast<double>(controller()->status().steps - zero_steps_) / steps_per_rad_;
      state_ = before;
    });
    return angle_rad;
  }

  TurntableState state() override { return state_; }

 private:
  struct Stopped : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  std::shared_ptr<MotionController> controller() {
    const std::lock_guard hold(exchange_);
    return controller_;
  }

  // The old controller is dropped first, because it holds the port.
  void reconnect() {
    set_controller(nullptr);
    auto found = connect_();
    steps_per_rad_ = found->identity().steps_per_deg / kDegree;
    set_controller(std::move(found));
    state_ = TurntableState::unknown_position;
    lost_ = false;
  }

  void set_controller(std::shared_ptr<MotionController> controller) {
    const std::lock_guard hold(exchange_);
    controller_ = std::move(controller);
  }

  void require_known_position(const std::string& asked) const {
    if (state_ == TurntableState::unknown_position)
      throw std::runtime_error("the platform was asked to " + asked + ", but its position is unknown; home it first");
  }

  // Does `work`. After any failure but a stop the position counts as unknown, and the motor is stopped.
  template <typename Work>
  void guarded(const Work& work) {
    try {
      work();
    } catch (const Stopped&) {
      throw;
    } catch (...) {
      state_ = TurntableState::unknown_position;
      lost_ = true;
      stop_quietly();
      throw;
    }
  }

  void stop_quietly() noexcept {
    try {
      controller()->stop();
    } catch (...) {  // the line is gone; the error that is being handled says so already
    }
  }

  // A stop() while the platform stood left the controller held, which is cleared here. One from now on ends the move.
  void begin_moving() {
    if (stop_asked_.exchange(false)) controller()->clear_stop();
    state_ = TurntableState::moving;
  }

  void approach(std::int64_t target) {
    const auto backlash = static_cast<std::int64_t>(std::ceil(setup_.backlash_rad * steps_per_rad_ - 1e-6));
    if (backlash > 0 && target < controller()->status().steps) travel(target - backlash);
    travel(target);
    state_ = TurntableState::idle;
  }

  void travel(std::int64_t target) {
    const int tolerance = controller()->identity().reading_tolerance_steps;
    std::int64_t stands_at = 0;
    for (int tries = 0; tries < kMostTries; ++tries) {
      controller()->start_move(target);
      stands_at = wait_to_stand_at(target, tolerance);
      if (std::abs(stands_at - target) <= tolerance) return;
    }
    throw std::runtime_error("the platform was asked to turn to " + place(target) + " " + std::to_string(kMostTries) +
                             " times and stands at " + place(stands_at) +
                             "; check the turntable's cable and that nothing else commands it, then home it");
  }

  std::string place(std::int64_t steps) const {
    return degrees(static_cast<double>(steps - zero_steps_) / steps_per_rad_);
  }

  std::int64_t wait_to_stand_at(std::int64_t target, int tolerance) {
    int there = 0, elsewhere = 0;
    return watch(
        [&](const MotionStatus& status) {
          const bool idle = status.motion == Motion::idle, near = std::abs(status.steps - target) <= tolerance;
          there = idle && near ? there + 1 : 0;
          elsewhere = idle && !near ? elsewhere + 1 : 0;
          return there >= kIdleReadings || elsewhere >= kLostReadings;
        },
        true);
  }

  std::int64_t wait_until_idle() {
    try {
      const std::int64_t steps = watch([](const MotionStatus& status) { return status.motion == Motion::idle; }, false);
      state_ = TurntableState::idle;
      return steps;
    } catch (const Stopped&) {
      throw PositionLost(kStoppedHoming);
    } catch (const PositionLost&) {
      if (stop_asked_) throw PositionLost(kStoppedHoming);
      throw;
    }
  }

  // Asks the controller for its status until `ended` returns true, and returns its position in steps; a stop throws.
  template <typename Ended>
  std::int64_t watch(const Ended& ended, bool stalls) {
    const double began_s = clock_.monotonic_s();
    double changed_s = began_s;
    std::int64_t before = 0;
    bool first = true;
    for (;;) {
      const MotionStatus status = controller()->status();
      const double now_s = clock_.monotonic_s();
      if (stop_asked_ || status.motion == Motion::held) end_at_stop();
      if (ended(status)) return status.steps;
      if (std::exchange(first, false) || status.steps != before || status.motion != Motion::moving) {
        changed_s = now_s;
        before = status.steps;
      }
      if (stalls && now_s - changed_s > setup_.stall_timeout_s) {
        throw std::runtime_error("the platform says that it turns and stays at " + place(status.steps) + " for " +
                                 std::to_string(setup_.stall_timeout_s) +
                                 " s; see that nothing blocks it, then home it");
      }
      if (now_s - began_s > setup_.move_timeout_s) {
        throw std::runtime_error("the platform has not come to rest within " + std::to_string(setup_.move_timeout_s) +
                                 " s; see that nothing blocks it and that the turntable is on, then home it");
      }
      clock_.sleep_s(kPollS);
    }
  }

  [[noreturn]] void end_at_stop() {
    stop_asked_ = false;
    controller()->clear_stop();
    const std::int64_t steps = controller()->status().steps;
    if (state_ == TurntableState::moving) state_ = TurntableState::stopped;
    throw Stopped("the platform was stopped at " + place(steps) +
                  " on its way; ask for the move again when it is safe");
  }

  ConnectController connect_;
  Clock& clock_;
  StepperSetup setup_;
  std::mutex exchange_;  // guards controller_
  std::shared_ptr<MotionController> controller_;
  double steps_per_rad_ = 1;
  std::int64_t zero_steps_ = 0;
  bool lost_ = false;
  std::atomic<TurntableState> state_ = TurntableState::unknown_position;
  std::atomic<bool> stop_asked_ = false;
};

}  // namespace

std::unique_ptr<Turntable> make_stepper_turntable(ConnectController connect, Clock& clock, const StepperSetup& setup) {
  return std::make_unique<StepperTurntable>(std::move(connect), clock, setup);
}

}  // namespace rig
