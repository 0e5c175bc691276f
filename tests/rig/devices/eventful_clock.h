// A clock whose time a test controls, and at which something happens.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "rig/devices/clock.h"

// Sleeping moves the clock on at once and does, in the sleeper's thread, what the test has planned. The time may be
// asked from any thread; plans are made in the thread that sleeps.
class EventfulClock final : public rig::Clock {
 public:
  double monotonic_s() override { return elapsed_s_; }
  std::string utc() override { return "2026-11-21T10:20:30.123Z"; }
  void sleep_s(double duration_s) override {
    if (pace > 0) std::this_thread::sleep_for(std::chrono::duration<double>(duration_s * pace));
    elapsed_s_ += duration_s;
    if (planned_ && elapsed_s_ >= planned_->at_s) std::exchange(planned_, std::nullopt)->event();
  }

  // Plans that `event` happens once, when somebody sleeps to or beyond `delay_s` from now; replaces what was planned
  // before.
  void plan(double delay_s, std::function<void()> event) {
    planned_ = Planned{.at_s = elapsed_s_ + delay_s, .event = std::move(event)};
  }
  bool planned() const { return planned_.has_value(); }

  double pace = 0;  // real seconds for each of its own, so that another thread can look on

 private:
  struct Planned {
    double at_s = 0;
    std::function<void()> event;
  };
  std::atomic<double> elapsed_s_ = 0;
  std::optional<Planned> planned_;
};
