// The driver on the second simulation of GRBL, which was written from the protocol's documentation alone.
#pragma once

#include <map>
#include <memory>

#include "rig/devices/degree.h"
#include "rig/turntables/controllers.h"
#include "rig/turntables/stepper_turntable.h"
#include "tests/rig/devices/eventful_clock.h"
#include "tests/support/documented_grbl.h"

// A documented board, right in every way unless a test says otherwise, with the driver on it.
struct DocumentedBench {
  explicit DocumentedBench(DocumentedGrblOptions options = right(), const std::map<int, double>& others = {})
      : board(clock, with(std::move(options), others)) {
    setup.steps_per_deg = 40;
    setup.home_by = stepper.home_by = rig::HomeBy::home_switch;
    stepper.move_timeout_s = 200;
  }
  static DocumentedGrblOptions with(DocumentedGrblOptions options, const std::map<int, double>& others) {
    for (const auto& [number, value] : others) options.eeprom[number] = value;
    return options;
  }
  static DocumentedGrblOptions right() {
    DocumentedGrblOptions options;
    options.homes_single_axis = true;
    options.homing = DocumentedGrblOptions::Homing::z_first;
    options.eeprom = documented_turntable_settings();
    return options;
  }
  static DocumentedGrblOptions as_it_comes() {
    DocumentedGrblOptions options;
    options.homing = DocumentedGrblOptions::Homing::z_first;
    return options;
  }
  std::unique_ptr<rig::Turntable> make_turntable() {
    return rig::make_stepper_turntable([this] { return rig::connect_grbl(board.open(), clock, setup); }, clock,
                                       stepper);
  }
  double at_rad() { return (board.platform_deg() - 361) * rig::kDegree; }  // the pull-off ends at 361 deg

  EventfulClock clock;
  DocumentedGrbl board;
  rig::ControllerSetup setup;
  rig::StepperSetup stepper;
};
