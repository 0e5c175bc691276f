#include "tests/support/documented_machine.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace {

constexpr double kSearch = 1.5, kLocatePullOffs = 5;  // of the travel, and of the pull-off
constexpr double kOtherAxisS = 1;                     // how long another axis with a switch takes to home
constexpr double kCoast = 0.25;  // of its braking way, that the platform turns on uncounted when it is halted

// The way from one angle to another in positive direction, 0 to 360.
double way_up(double from_deg, double to_deg) {
  const double way = std::fmod(to_deg - from_deg, 360);
  return way < 0 ? way + 360 : way;
}

}  // namespace

DocumentedMachine::DocumentedMachine(const DocumentedGrblOptions& options)
    : options_(options), uncounted_steps_(std::round(options.stands_at_deg * options.steps_per_deg)) {}

double DocumentedMachine::platform_deg() const {
  return (std::round(axis_.steps()) + uncounted_steps_) / options_.steps_per_deg;
}

void DocumentedMachine::halt() {
  const double coasts = std::round(kCoast * axis_.braking_steps() * axis_.direction());
  axis_.halt();
  uncounted_steps_ += coasts;
}

void DocumentedMachine::count_from(double steps) {
  const double rotor = std::round(axis_.steps()) + uncounted_steps_;
  axis_.count_from(std::round(steps));
  uncounted_steps_ = rotor - axis_.steps();
}

bool DocumentedMachine::switch_closed() const {
  return options_.switch_deg && way_up(*options_.switch_deg, platform_deg()) < options_.switch_width_deg;
}

bool DocumentedMachine::passes_switch(double from_deg, double to_deg) const {
  if (!options_.switch_deg || from_deg == to_deg) return false;
  const double low = std::min(from_deg, to_deg), high = std::max(from_deg, to_deg);
  return switch_closed() || way_up(low, *options_.switch_deg) < high - low;
}

std::optional<double> DocumentedMachine::steps_to_switch(double direction) const {
  if (!options_.switch_deg) return std::nullopt;
  if (switch_closed()) return 0;
  const double way_deg = direction > 0 ? way_up(platform_deg(), *options_.switch_deg)
                                       : way_up(*options_.switch_deg + options_.switch_width_deg, platform_deg());
  return std::ceil(way_deg * options_.steps_per_deg - 1e-9) + (direction > 0 ? 0 : 1);  // at the edge it is open
}

void DocumentedHoming::begin(bool other_axes, bool x, double now_s) {
  homes_x_ = x;
  if (!other_axes) return search();
  phase_ = Phase::other_axes;
  waits_ = true;
  wait_until_s_ = now_s + (options_.switches_on_other_axes ? kOtherAxisS : other_axis_search_s());
}

// Z runs over the whole way of its search.
double DocumentedHoming::other_axis_search_s() const {
  return kSearch * settings_.at(132) / (std::min(settings_.at(25), settings_.at(112)) / 60);
}

void DocumentedHoming::turn_by(double steps, double mm_per_minute, bool abrupt) {
  DocumentedAxis& axis = machine_.axis();
  const double target = std::round(axis.steps()) + std::round(steps);
  if (target == std::round(axis.steps())) return;
  axis.add({.target = target,
            .speed = std::min(mm_per_minute, settings_.at(110)) / 60 * settings_.at(100),
            .acceleration = settings_.at(120) * settings_.at(100),
            .abrupt = abrupt});
}

void DocumentedHoming::approach(Phase phase, double limit_mm, double mm_per_minute) {
  phase_ = phase;
  waits_ = false;
  const double limit = limit_mm * settings_.at(100);
  const std::optional<double> way = machine_.steps_to_switch(direction());
  finds_switch_ = way && *way <= limit;
  turn_by(direction() * (finds_switch_ ? *way : limit), mm_per_minute, finds_switch_);
}

void DocumentedHoming::search() {
  approach(Phase::search, kSearch * settings_.at(130), settings_.at(25));
}

void DocumentedHoming::pull_off(Phase phase, double mm_per_minute) {
  phase_ = phase;
  turn_by(-direction() * settings_.at(27) * settings_.at(100), mm_per_minute, false);
}

std::optional<int> DocumentedHoming::go_on(double now_s) {
  if (machine_.axis().turning() || (waits_ && now_s < wait_until_s_)) return std::nullopt;
  switch (phase_) {
    case Phase::other_axes:
      if (!options_.switches_on_other_axes) return 9;
      if (!homes_x_) return 0;
      search();
      return std::nullopt;
    case Phase::search:
    case Phase::locate:
      if (!finds_switch_) return 9;
      if (!std::exchange(waits_, !waits_))  // for the switch to stop bouncing
        wait_until_s_ = now_s + settings_.at(26) / 1000;
      else if (phase_ == Phase::search)
        pull_off(Phase::pull_off, settings_.at(25));
      else
        pull_off(Phase::pull_off_again, settings_.at(24));
      return std::nullopt;
    case Phase::pull_off:
      if (machine_.switch_closed()) return 8;
      approach(Phase::locate, kLocatePullOffs * settings_.at(27), settings_.at(24));
      return std::nullopt;
    case Phase::pull_off_again:
      return found();
  }
  return std::nullopt;
}

// Machine space is negative, whichever end the switch is at.
int DocumentedHoming::found() const {
  if (machine_.switch_closed()) return 8;
  const double off_mm = settings_.at(27);
  machine_.count_from((direction() > 0 ? -off_mm : off_mm - settings_.at(130)) * settings_.at(100));
  return 0;
}
