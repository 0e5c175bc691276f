#include "rig/turntables/stepper_turntable.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "rig/devices/degree.h"

namespace rig {
namespace {
constexpr double kAngleEveryS = 0.05;
constexpr int kMostBeginnings = 4;  // of a move: begun once and repeated three times
constexpr int kIdleReadings = 2;    // so many in a row at the target: the platform has arrived
constexpr int kLostReadings = 6;    // so many in a row elsewhere: the command was lost
constexpr int kMostReadings = 20;   // for two equal ones of a platform that stands
constexpr double kLeashS = 1;       // the controller is told of no place farther away than what is turned in this time
constexpr int kPiecesPerLeash = 4;
constexpr const char* kStoppedHoming = "the platform was stopped while it looked for its home; home it again";
constexpr double kLargestSteps = 1 << 24;  // GRBL counts in single precision, 24 bits

std::string degrees(double angle_rad) {
  return std::to_string(angle_rad / kDegree) + " deg";
}

// stop(), state() and angle_rad() of a platform that turns may be called from any thread, everything else from one.
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
      if (setup_.home_by == HomeBy::here && setup_.memory) return_from_where_it_was_left(zero_steps_);
      zero_known_ = true;
    });
  }

  void stands_at(double angle_rad) override {
    require_known_position("take another angle for its own");
    if (setup_.home_by != HomeBy::here) return Turntable::stands_at(angle_rad);
    guarded([&] {
      const std::int64_t steps = standing_steps();
      zero_steps_ = steps - std::llround(angle_rad * steps_per_rad_);
      keep_place(steps, false);
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
    const StopUnderWay here(stops_under_way_);
    stop_asked_ = true;
    if (const auto found = controller()) found->stop();
    auto standing = TurntableState::idle;  // while it moves, the moving thread sets `stopped`; unknown stays unknown
    state_.compare_exchange_strong(standing, TurntableState::stopped);
  }

  double angle_rad() override {
    if (state_ == TurntableState::moving) return passing_rad_;
    require_known_position("tell its angle");
    double angle_rad = 0;
    const TurntableState before = state_;
    guarded([&] {
      angle_rad = angle_of(standing_steps());
      state_ = before;
    });
    return angle_rad;
  }

  TurntableState state() override { return state_; }

 private:
  struct Stopped : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  struct StopUnderWay {
    explicit StopUnderWay(std::atomic<int>& counted) : count(counted) { ++count; }
    ~StopUnderWay() { --count; }
    StopUnderWay(const StopUnderWay&) = delete;
    StopUnderWay& operator=(const StopUnderWay&) = delete;
    std::atomic<int>& count;
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
    lost_ = zero_known_ = false;
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
    } catch (const PositionLost&) {
      if (state_ == TurntableState::moving) lose_place();
      give_up();
      throw;
    } catch (...) {
      give_up();
      throw;
    }
  }

  void give_up() noexcept {
    state_ = TurntableState::unknown_position;
    lost_ = true;
    stop_quietly();
  }

  void lose_place() noexcept {
    try {
      if (setup_.memory) setup_.memory->keep({.lost = true});
    } catch (...) {  // its disk is full; the error that is being handled is the one to be said
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

  // Why the place that is remembered says nothing about the present one; empty: it does. A controller whose board was
  // reset counts from 0; then the place is known only if the platform stood.
  std::string doubt(const PlatformPlace& left, std::int64_t counted) {
    const ControllerIdentity identity = controller()->identity();
    if (left.lost) return "a program before this one has lost it";
    if (identity.count_lost) return "its controller reported an alarm";
    if (counted == 0)
      return left.turning ? "it was turning when the last program ended, and its controller has been reset since" : "";
    const bool moved = !left.turning && std::abs(counted - left.steps) > identity.reading_tolerance_steps;
    return moved ? "its controller counts otherwise than when the last program left it" : "";
  }

  // Without a home switch a platform that was left somewhere is turned back from there.
  void return_from_where_it_was_left(std::int64_t counted) {
    const std::optional<PlatformPlace> left = setup_.memory->recall();
    zero_known_ = true;
    if (!left) return keep_place(counted, false);
    const bool reset = counted == 0 && left->steps != 0;
    if (const std::string why = doubt(*left, counted); !why.empty()) {
      zero_known_ = false;
      state_ = TurntableState::unknown_position;
      lose_place();
      if (!setup_.memory->ask_for_mark(why))
        throw PositionLost("nobody knows where the platform stands: " + why +
                           "; turn it to its mark, then say so with \"threadstation home --mark\"");
      zero_steps_ = standing_steps();
      zero_known_ = true;
      state_ = TurntableState::idle;
      return keep_place(zero_steps_, false);
    }
    const auto turned_since = static_cast<double>(reset ? 0 : counted - left->steps);
    zero_steps_ = counted - std::llround(left->angle_rad * steps_per_rad_ + turned_since);
    state_ = TurntableState::moving;  // a stop that was asked for meanwhile still counts
    approach(zero_steps_);
  }

  void keep_place(std::int64_t steps, bool turning) {
    if (setup_.memory && zero_known_) setup_.memory->keep({steps, angle_of(steps), turning});
  }

  void approach(std::int64_t target) {
    const auto backlash = static_cast<std::int64_t>(std::ceil(setup_.backlash_rad * steps_per_rad_ - 1e-6));
    const std::int64_t from = standing_steps();
    keep_place(from, true);
    if (backlash > 0 && target < from) travel(target - backlash);
    travel(target);
    keep_place(target, false);
    state_ = TurntableState::idle;
  }

  // Turns on a leash: should this program die on the way, the controller stops by itself within kLeashS.
  void travel(std::int64_t target) {
    const ControllerIdentity identity = controller()->identity();
    const int tolerance = identity.reading_tolerance_steps;
    const auto leash =
        std::max<std::int64_t>(kPiecesPerLeash, std::llround(identity.speed_deg_s * identity.steps_per_deg * kLeashS));
    std::int64_t stands_at = standing_steps();
    for (int tries = 0; tries < kMostBeginnings; ++tries) {
      const std::int64_t began_at = stands_at;
      stands_at = turn_on_leash(stands_at, target, leash, tolerance);
      if (std::abs(stands_at - target) <= tolerance) return;
      stands_at = standing_steps();                               // the next piece begins there
      if (std::abs(stands_at - began_at) > tolerance) tries = 0;  // only a part of the way was lost
    }
    throw std::runtime_error("the platform was asked to turn to " + place(target) + " " +
                             std::to_string(kMostBeginnings) + " times and stands at " + place(stands_at) +
                             "; check the turntable's cable and that nothing else commands it, then home it");
  }

  double angle_of(std::int64_t steps) const { return static_cast<double>(steps - zero_steps_) / steps_per_rad_; }

  std::string place(std::int64_t steps) const { return degrees(angle_of(steps)); }

  // The place where a platform stands that does not turn: two readings in a row have to agree, because a digit that was
  // garbled on the wire looks like any other.
  std::int64_t standing_steps() {
    std::int64_t before = controller()->status().steps;
    for (int readings = 1; readings < kMostReadings; ++readings) {
      const std::int64_t steps = controller()->status().steps;
      if (steps == before) return steps;
      before = steps;
    }
    throw PositionLost("the turntable was asked where it stands " + std::to_string(kMostReadings) +
                       " times and never said the same twice in a row; check its cable, then home it");
  }

  // Turns from `from` towards `target`. Returns where the platform came to stand: there, or where a command got lost.
  std::int64_t turn_on_leash(std::int64_t from, std::int64_t target, std::int64_t leash, int tolerance) {
    const std::int64_t piece = leash / kPiecesPerLeash;
    std::int64_t goal = from + std::clamp(target - from, -leash, leash);
    controller()->start_move(goal);
    int there = 0, elsewhere = 0;
    std::int64_t before = from;
    return watch(
        [&](const MotionStatus& status) {
          const bool idle = status.motion == Motion::idle, near = std::abs(status.steps - goal) <= tolerance;
          const bool same = std::exchange(before, status.steps) == status.steps;
          there = !idle || !near || goal != target ? 0 : same ? there + 1 : 1;
          elsewhere = idle && !near ? elsewhere + 1 : 0;
          if (goal != target && std::abs(goal - status.steps) <= leash - piece) {
            goal += std::clamp(target - goal, -piece, piece);  // a piece at a time, whatever a garbled digit says
            controller()->start_move(goal);
          }
          return there >= kIdleReadings || elsewhere >= kLostReadings;
        },
        true);
  }

  // The place where the platform stands after homing, read twice.
  std::int64_t wait_until_idle() {
    std::optional<std::int64_t> before;
    try {
      const std::int64_t steps = watch(
          [&](const MotionStatus& status) {
            if (status.motion != Motion::idle) before.reset();
            return status.motion == Motion::idle && std::exchange(before, status.steps) == status.steps;
          },
          false);
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
      passing_rad_ = angle_of(status.steps);
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
      clock_.sleep_s(kAngleEveryS);
    }
  }

  // A stop() that is still being written would end the next move, too.
  [[noreturn]] void end_at_stop() {
    while (stops_under_way_ > 0) std::this_thread::yield();
    stop_asked_ = false;
    controller()->clear_stop();
    const std::int64_t steps = standing_steps();
    keep_place(steps, false);
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
  bool lost_ = false, zero_known_ = false;
  std::atomic<double> passing_rad_ = 0;  // the last reading of a platform that turns
  std::atomic<TurntableState> state_ = TurntableState::unknown_position;
  std::atomic<bool> stop_asked_ = false;
  std::atomic<int> stops_under_way_ = 0;
};

}  // namespace

std::unique_ptr<Turntable> make_stepper_turntable(ConnectController connect, Clock& clock, const StepperSetup& setup) {
  return std::make_unique<StepperTurntable>(std::move(connect), clock, setup);
}

}  // namespace rig
