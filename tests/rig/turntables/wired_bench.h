// A small bench whose platform is turned by simulated firmware, and the driver that speaks to it.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <ostream>
#include <string>

#include "rig/devices/clock.h"
#include "rig/devices/degree.h"
#include "rig/simulated/simulated_bench.h"
#include "rig/simulated/simulated_port.h"
#include "rig/turntables/controllers.h"
#include "rig/turntables/stepper_turntable.h"
#include "tests/rig/devices/eventful_clock.h"
#include "tests/support/documented_firmware.h"

enum class Protocol { grbl, documented_grbl, zaber };

inline std::ostream& operator<<(std::ostream& out, Protocol protocol) {
  return out << (protocol == Protocol::grbl ? "Grbl" : protocol == Protocol::zaber ? "Zaber" : "DocumentedGrbl");
}

template <typename ClockKind>
struct WiredBench {
  static constexpr double kStepsPerDeg = 40;
  static constexpr double kStepRad = rig::kDegree / kStepsPerDeg;

  explicit WiredBench(Protocol which, rig::HomeBy home_by = rig::HomeBy::home_switch, rig::LineFaultPlan faults = {},
                      double speed_deg_s = 30)
      : protocol(which),
        bench({.turntable = {.scale = 1, .step_rad = kStepRad, .speed_rad_s = speed_deg_s * rig::kDegree}},
              [](const rig::BenchState& state) {
                return cv::Mat3f(state.lens.height_px, state.lens.width_px, cv::Vec3f::all(0.1F));
              }) {
    setup.steps_per_deg = kStepsPerDeg;
    setup.home_by = stepper.home_by = home_by;
    bench.turn_platform(50 * rig::kDegree);  // where somebody left the platform
    power_on_another(std::move(faults));
  }

  // Puts another controller in the place of the one before, if any: it counts from where the platform stands.
  void power_on_another(rig::LineFaultPlan faults = {}) {
    const rig::SimulatedMotor motor(bench, clock, kStepsPerDeg);
    const bool with_switch = setup.home_by == rig::HomeBy::home_switch;
    const bool at_once = !faults.empty();
    auto firmware = protocol == Protocol::grbl    ? rig::make_simulated_grbl(motor, clock, with_switch)
                    : protocol == Protocol::zaber ? rig::make_simulated_zaber(motor)
                                                  : make_documented_firmware(bench, clock, with_switch, at_once);
    port = rig::make_simulated_port(std::move(firmware), std::move(faults));
  }

  std::shared_ptr<rig::MotionController> connect(std::shared_ptr<rig::ByteLine> line) {
    return protocol == Protocol::zaber ? rig::connect_zaber(std::move(line), clock, setup)
                                       : rig::connect_grbl(std::move(line), clock, setup);
  }

  std::unique_ptr<rig::Turntable> make_turntable() {
    return rig::make_stepper_turntable([this] { return connect(open_line()); }, clock, stepper);
  }

  double true_angle_rad() const { return bench.state().platform_angle_rad; }
  // How far the platform stands from an angle, whole turns apart: a homing in one direction may end a turn further on.
  double off_rad(double angle_rad) const { return std::remainder(true_angle_rad() - angle_rad, 2 * std::numbers::pi); }

  Protocol protocol;
  ClockKind clock = make_clock();
  rig::ControllerSetup setup;
  rig::StepperSetup stepper;
  rig::SimulatedBench bench;
  std::shared_ptr<rig::SimulatedPort> port;
  std::function<std::unique_ptr<rig::ByteLine>()> open_line = [this] { return rig::open_simulated_line(port, clock); };

 private:
  static ClockKind make_clock() {
    if constexpr (std::is_same_v<ClockKind, rig::SimulatedClock>)
      return rig::SimulatedClock(1.8e9, 0.02);  // another thread may look on
    else
      return {};
  }
};
