// The stepper motor under the simulated platform: gains speed, runs, slows down on the injected clock, and turns the
// bench's platform with it.
//
// Two counts of steps: what its controller counts, which begins anywhere, and where the rotor is, 0 at the platform's
// true angle 0. They part when the motor is jammed or the controller loses its count.
#pragma once

#include "rig/clock.h"
#include "rig/simulated_bench.h"

namespace rig {

class SimulatedMotor {
 public:
  // `bench` and `clock` must outlive the motor. The acceleration lets it reach its speed in a fifth of a second.
  SimulatedMotor(SimulatedBench& bench, Clock& clock, double steps_per_deg);

  double steps_per_deg() const { return steps_per_deg_; }
  double full_speed_deg_s() const;

  void go_to(double counted_steps, double speed_deg_s);
  void slow_down();  // to a stand, in the shortest time
  void halt();       // at once
  void count_from(double counted_steps) { counted_from_rotor_ = counted_steps - rotor_steps_ - jammed_steps_; }
  void jam(bool jammed) { jammed_ = jammed; }

  void update();  // to the clock's time; each question below is about the last update
  bool turning() const { return speed_steps_s_ != 0 || counted_steps() != target_steps_; }
  double speed_deg_s() const { return speed_steps_s_ / steps_per_deg_; }
  double counted_steps() const { return rotor_steps_ + jammed_steps_ + counted_from_rotor_; }
  double counted_at_true_zero() const { return jammed_steps_ + counted_from_rotor_; }

 private:
  void advance(double duration_s);
  void move_rotor(double by_steps);

  SimulatedBench& bench_;
  Clock& clock_;
  double steps_per_deg_;
  double rotor_steps_ = 0, counted_from_rotor_ = 0;
  double jammed_steps_ = 0;  // counted and not turned
  double target_steps_ = 0;  // counted
  double speed_steps_s_ = 0, wanted_speed_steps_s_ = 0;
  double updated_s_ = 0;
  bool slowing_ = false, jammed_ = false;
};

}  // namespace rig
