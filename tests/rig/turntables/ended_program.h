// How a program ends that drives a turntable without a home switch, and what it leaves behind for the next one.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "rig/devices/clock.h"
#include "rig/turntables/byte_line.h"
#include "rig/turntables/stepper_turntable.h"

// The line of a program that is killed: from then on nothing is written and nothing heard.
class MortalLine final : public rig::ByteLine {
 public:
  MortalLine(std::unique_ptr<rig::ByteLine> line, rig::Clock& clock, const std::atomic<bool>& killed)
      : line_(std::move(line)), clock_(clock), killed_(killed) {}
  std::string read(double timeout_s) override {
    if (!killed_) return line_->read(timeout_s);
    clock_.sleep_s(timeout_s);
    return {};
  }
  void write(std::string_view bytes) override {
    if (!killed_) line_->write(bytes);
  }

 private:
  std::unique_ptr<rig::ByteLine> line_;
  rig::Clock& clock_;
  const std::atomic<bool>& killed_;
};

class Memory final : public rig::PlatformMemory {
 public:
  std::optional<rig::PlatformPlace> recall() override { return place; }
  void keep(const rig::PlatformPlace& now) override { place = now; }
  bool ask_for_mark(const std::string&) override {
    ++asked;
    if (turn_to_mark) turn_to_mark();
    return turn_to_mark != nullptr;
  }

  std::optional<rig::PlatformPlace> place;
  std::function<void()> turn_to_mark;
  int asked = 0;
};
