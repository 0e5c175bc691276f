#include "rig/simulated/lamp_changes.h"

#include <algorithm>
#include <cmath>

namespace rig {
namespace {

// The light that a lamp with PWM gives from time 0 to `time_s`, in seconds of its mean strength.
double switched_light_s(const LampChanges& changes, double time_s) {
  const double periods = time_s * changes.pwm_hz, whole = std::floor(periods);
  return (whole + std::min((periods - whole) / changes.pwm_duty, 1.0)) / changes.pwm_hz;
}

}  // namespace

double lamp_strength(const LampChanges& changes, double begin_s, double exposure_s) {
  const double end_s = begin_s + exposure_s;
  const double middle_s = begin_s + exposure_s / 2;
  const double drifted =
      (1 + changes.drift_per_s * middle_s) * (1 - changes.warm_up * std::exp(-middle_s / changes.warm_up_s));
  const double after_jump = std::clamp((end_s - changes.jump_at_s) / exposure_s, 0.0, 1.0);
  const double switched =
      changes.pwm_hz > 0 ? (switched_light_s(changes, end_s) - switched_light_s(changes, begin_s)) / exposure_s : 1.0;
  return std::max(0.0, drifted * (1 + changes.jump * after_jump) * switched);
}

}  // namespace rig
