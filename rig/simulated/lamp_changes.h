// How the strength of the simulated lamp changes with the rig's clock.
#pragma once

namespace rig {

// Strength 1 is the intensity that TrueLamp states. The defaults describe a constant lamp.
struct LampChanges {
  double drift_per_s = 0.0;  // relative change of the strength per second since the clock's start
  double jump = 0.0;         // relative change at one instant; -1: the lamp goes out
  double jump_at_s = 0.0;
  double warm_up = 0.0;     // part of the strength that is missing at the clock's start; it falls exponentially ...
  double warm_up_s = 60.0;  // ... with this time constant
  double pwm_hz = 0.0;      // frequency at which the lamp is switched on and off; 0: never
  double pwm_duty = 1.0;    // part of the period during which it is on, brighter by 1 / pwm_duty: the mean is unchanged
};

// The mean strength over an exposure that begins at `begin_s` on the rig's clock; never below 0.
double lamp_strength(const LampChanges& changes, double begin_s, double exposure_s);

}  // namespace rig
