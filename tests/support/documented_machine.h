// What the documented GRBL (documented_grbl.h) moves: the motor of its X axis, the platform on it and the home switch;
// and its homing cycle.
#pragma once

#include <optional>

#include "tests/support/documented_axis.h"
#include "tests/support/documented_grbl.h"
#include "tests/support/documented_settings.h"

class DocumentedMachine {
 public:
  explicit DocumentedMachine(const DocumentedGrblOptions& options);

  DocumentedAxis& axis() { return axis_; }
  const DocumentedAxis& axis() const { return axis_; }
  double platform_deg() const;    // the true angle
  void halt();                    // the motor stops at once; what turned goes on for a while, which nobody counts
  void count_from(double steps);  // changes the count, not the angle; the motor stands

  bool switch_closed() const;
  bool passes_switch(double from_deg, double to_deg) const;
  // The way in steps, in the direction 1 or -1, after which the switch is closed; nothing when there is none.
  std::optional<double> steps_to_switch(double direction) const;

 private:
  DocumentedGrblOptions options_;
  DocumentedAxis axis_;         // counts the machine's steps
  double uncounted_steps_ = 0;  // the rotor's steps, less those
};

// A search over 1.5 x the travel, a pull-off, a slow approach and another pull-off.
class DocumentedHoming {
 public:
  DocumentedHoming(DocumentedMachine& machine, const DocumentedSettings& settings, const DocumentedGrblOptions& options)
      : machine_(machine), settings_(settings), options_(options) {}

  void begin(bool other_axes, bool x, double now_s);
  std::optional<int> go_on(double now_s);  // nothing: it is not over; then its alarm, 0 for none

 private:
  enum class Phase { other_axes, search, pull_off, locate, pull_off_again };

  double direction() const { return (static_cast<int>(settings_.at(23)) & 1) != 0 ? -1 : 1; }
  double other_axis_search_s() const;
  void turn_by(double steps, double mm_per_minute, bool abrupt);
  void approach(Phase phase, double limit_mm, double mm_per_minute);
  void search();
  void pull_off(Phase phase, double mm_per_minute);
  int found() const;

  DocumentedMachine& machine_;
  const DocumentedSettings& settings_;
  const DocumentedGrblOptions& options_;
  Phase phase_ = Phase::search;
  double wait_until_s_ = 0;
  bool waits_ = false, homes_x_ = true, finds_switch_ = false;
};
