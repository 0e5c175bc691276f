#include "rig/simulated/simulated_motor.h"

#include <algorithm>
#include <cmath>

#include "rig/devices/degree.h"

namespace rig {
namespace {
constexpr double kSliceS = 0.001;
constexpr double kSpeedUpS = 0.2;

}  // namespace

SimulatedMotor::SimulatedMotor(SimulatedBench& bench, Clock& clock, double steps_per_deg)
    : bench_(bench), clock_(clock), steps_per_deg_(steps_per_deg), updated_s_(clock.monotonic_s()) {
  rotor_steps_ = std::round(bench.state().platform_angle_rad / bench.truth().turntable.scale / kDegree * steps_per_deg);
  count_from(0);
}

double SimulatedMotor::full_speed_deg_s() const {
  return bench_.truth().turntable.speed_rad_s / kDegree;
}

double SimulatedMotor::acceleration_deg_s2() const {
  return full_speed_deg_s() / kSpeedUpS;
}

void SimulatedMotor::go_to(double counted_steps, double speed_deg_s) {
  update();
  target_steps_ = std::round(counted_steps);
  wanted_speed_steps_s_ = speed_deg_s * steps_per_deg_;
  slowing_ = false;
}

void SimulatedMotor::slow_down() {
  update();
  slowing_ = true;
}

void SimulatedMotor::halt() {
  update();
  speed_steps_s_ = 0;
  move_rotor(std::round(counted_steps()) - counted_steps());
  target_steps_ = counted_steps();
}

void SimulatedMotor::update() {
  const double now_s = clock_.monotonic_s();
  while (updated_s_ < now_s && turning()) {
    const double slice_s = std::min(kSliceS, now_s - updated_s_);
    advance(slice_s);
    updated_s_ += slice_s;
  }
  updated_s_ = now_s;
}

// One slice of time, in which the speed changes towards the largest one from which the motor can still stop at the
// target.
void SimulatedMotor::advance(double duration_s) {
  const double acceleration = acceleration_deg_s2() * steps_per_deg_;
  const double change = acceleration * duration_s;
  const double left = target_steps_ - counted_steps();
  const double allowed = std::min(wanted_speed_steps_s_, std::sqrt(2 * acceleration * std::abs(left)));
  const double wanted = slowing_ ? 0 : std::copysign(allowed, left);
  speed_steps_s_ += std::clamp(wanted - speed_steps_s_, -change, change);
  const double way = speed_steps_s_ * duration_s;
  if (slowing_ && speed_steps_s_ == 0) {
    move_rotor(std::round(counted_steps()) - counted_steps());
    target_steps_ = counted_steps();
  } else if (!slowing_ && std::abs(left) <= std::max(0.5, std::abs(way))) {
    move_rotor(left);
    speed_steps_s_ = 0;
    target_steps_ = counted_steps();
  } else {
    move_rotor(way);
  }
}

void SimulatedMotor::move_rotor(double by_steps) {
  (jammed_ ? jammed_steps_ : rotor_steps_) += by_steps;
  if (!jammed_ && by_steps != 0) {
    const double reading_rad = std::round(rotor_steps_) / steps_per_deg_ * kDegree;
    bench_.turn_platform(bench_.truth().turntable.scale * reading_rad);
  }
}

}  // namespace rig
