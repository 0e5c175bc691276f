// How the simulated lamp's light changes with the rig's clock: everything it lights changes alike.
#pragma once

namespace rig {

// All 0: a constant lamp. Strength 1 is the intensity that TrueLamp states.
struct LampChanges {
  double drift_per_s = 0.0;  // relative change of the strength per second since the clock's start
  double jump = 0.0;         // relative change at one instant; -1: the lamp goes out
  double jump_at_s = 0.0;
  double warm_up = 0.0;     // part of the strength that is missing at the clock's start, ...
  double warm_up_s = 60.0;  // ... a third of it after so long
  double pwm_hz = 0.0;      // switched on and off this often, ...
  double pwm_duty = 1.0;    // ... on for this part of the period, brighter by its inverse; mean strength unchanged
};

// Mean strength over an exposure that begins at `begin_s` on the rig's clock; never below 0.
double lamp_strength(const LampChanges& changes, double begin_s, double exposure_s);

}  // namespace rig
