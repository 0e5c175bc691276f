#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "rig/devices/tracked_turntable.h"
#include "rig/simulated/simulated_bench.h"

namespace rig {
namespace {

constexpr double kStopNoticedS = 0.02;  // the longest time until a stop is noticed

// Only the thread in home() or move_to() touches the bench; others may call stop(), state() and angle_rad().
class SimulatedTurntable final : public TrackedTurntable {
 public:
  SimulatedTurntable(SimulatedBench& bench, Clock& clock) : bench_(bench), clock_(clock) {}

  void home() override {
    begin_moving();
    if (!travel(bench_.state().platform_angle_rad / truth().scale, 0.0)) {
      end_moving(TurntableState::unknown_position);
      throw std::runtime_error("the platform was stopped while it looked for its home; home it again");
    }
    end_moving(TurntableState::idle);
  }

  void move_to(double wanted_rad) override {
    require_reachable(wanted_rad);
    const double target_rad = nearest_step(wanted_rad);
    begin_moving();
    const bool arrived = travel(reading_rad(), target_rad);
    end_moving(arrived ? TurntableState::idle : TurntableState::stopped);
    if (!arrived) {
      throw std::runtime_error("the platform was stopped at " + degrees_text(reading_rad()) + " on its way to " +
                               degrees_text(target_rad) + "; ask for the move again when it is safe");
    }
  }

 private:
  const TrueTurntable& truth() const { return bench_.truth().turntable; }

  double nearest_step(double angle_rad) const {
    const double step_rad = truth().step_rad;
    return step_rad > 0 ? std::round(angle_rad / step_rad) * step_rad : angle_rad;
  }

  void stand_at(double reading_rad) {
    came_to(reading_rad);
    bench_.turn_platform(truth().scale * reading_rad);
  }

  // Turns the platform in slices of time; returns false when it was stopped on the way.
  bool travel(double from_rad, double to_rad) {
    const double duration_s = std::abs(to_rad - from_rad) / truth().speed_rad_s;
    for (double done_s = 0; done_s < duration_s;) {
      const double slice_s = std::min(kStopNoticedS, duration_s - done_s);
      clock_.sleep_s(slice_s);
      done_s += slice_s;
      stand_at(nearest_step(from_rad + (to_rad - from_rad) * (done_s / duration_s)));
      if (stop_asked()) return false;
    }
    stand_at(to_rad);
    return true;
  }

  SimulatedBench& bench_;
  Clock& clock_;
};

}  // namespace

std::unique_ptr<Turntable> make_simulated_turntable(SimulatedBench& bench, Clock& clock) {
  return std::make_unique<SimulatedTurntable>(bench, clock);
}

}  // namespace rig
