// The stepper motor under the simulated platform: it speeds up, runs and slows down on the injected clock, and turns
// the bench's platform.
//
// There are two counts of steps: the controller's ("counted"), which begins anywhere, and the rotor's, which is 0 at
// the platform's true angle 0. They differ when the motor is jammed or the controller loses its count.
#pragma once

#include "rig/devices/clock.h"
#include "rig/simulated/simulated_bench.h"

namespace rig {

class SimulatedMotor {
 public:
  // `bench` and `clock` must outlive the motor, which reaches its full speed in a fifth of a second.
  SimulatedMotor(SimulatedBench& bench, Clock& clock, double steps_per_deg);

  double steps_per_deg() const { return steps_per_deg_; }
  double full_speed_deg_s() const;
  double acceleration_deg_s2() const;

  void go_to(double counted_steps, double speed_deg_s);
  void slow_down();  // comes to a stand as fast as the acceleration allows
  void halt();       // stands still at once
  void count_from(double counted_steps) { counted_from_rotor_ = counted_steps - rotor_steps_ - jammed_steps_; }
  void jam(bool jammed) { jammed_ = jammed; }

  void update();  // moves up to the clock's time; the questions below are about the last update
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
  double jammed_steps_ = 0;  // steps that were counted and not turned
  double target_steps_ = 0;  // in the controller's count
  double speed_steps_s_ = 0, wanted_speed_steps_s_ = 0;
  double updated_s_ = 0;
  bool slowing_ = false, jammed_ = false;
};

}  // namespace rig
