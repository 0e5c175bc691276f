#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <deque>
#include <optional>
#include <utility>

#include "rig/simulated/simulated_controller.h"
#include "rig/simulated/simulated_grbl_settings.h"
#include "rig/turntables/grbl_code.h"

namespace rig {
namespace {

constexpr std::size_t kPlannerBlocks = 15;
constexpr std::size_t kLongestLine = 80;
constexpr int kOffsetEvery = 10, kOverridesEvery = 20;  // the offset is in every tenth report, for example

struct Block {
  double from_steps, target_steps;
  double speed_deg_s;
  bool jog;
  double way_steps() const { return target_steps - from_steps; }
};

enum class State { idle, run, hold, jog, alarm, home };

class SimulatedGrbl final : public SimulatedController {
 public:
  SimulatedGrbl(const SimulatedMotor& motor, Clock& clock, bool with_switch)
      : SimulatedController(motor), clock_(clock), with_switch_(with_switch), settings_(motor, with_switch) {
    power_on();
  }

 private:
  void start() override {
    wait_for_reset_ = false;
    greet(settings_.at(22) != 0);
  }

  void take(char byte) override {
    if (!real_time(byte)) collect(byte);
  }

  double machine_deg() const { return std::round(motor_.counted_steps()) / settings_.at(100); }

  // Starts the firmware after power-on or reset.
  void greet(bool locked) {
    line_.clear();
    waiting_.clear();
    planner_.clear();
    going_to_.reset();
    dwell_until_s_.reset();
    homing_ = false;
    modes_ = {};
    offset_deg_ = 0;
    reports_to_offset_ = 0;
    reports_to_overrides_ = 1;
    state_ = locked ? State::alarm : State::idle;
    say("");
    say("Grbl 1.1h ['$' for help]");
    if (locked) say("[MSG:'$H'|'$X' to unlock]");
  }

  void soft_reset() {
    const bool was_homing = homing_, was_turning = motor_.speed_deg_s() != 0;
    motor_.halt();
    bool locked = state_ == State::alarm || wait_for_reset_;
    if (was_homing || was_turning) {
      say(was_homing ? "ALARM:6" : "ALARM:3");
      locked = true;
    }
    wait_for_reset_ = false;
    greet(locked);
  }

  void run_into_switch() override {
    motor_.halt();
    planner_.clear();
    state_ = State::alarm;
    say("ALARM:1");
    say("[MSG:Reset to continue]");
    wait_for_reset_ = true;
  }

  // Obeys a real-time command, which GRBL takes out of the stream of lines; false when the byte is none.
  bool real_time(char byte) {
    switch (byte) {
      case '\x18':
        soft_reset();
        return true;
      case '?':
        if (!wait_for_reset_) report();
        return true;
      case '!':
        hold();
        return true;
      case '~':
        resume();
        return true;
      case '\x85':
        if (state_ == State::jog) {
          planner_.clear();
          motor_.slow_down();
        }
        return true;
      default:
        return false;
    }
  }

  void hold() {
    if (state_ == State::run) {
      motor_.slow_down();
      state_ = State::hold;
    } else if (state_ == State::idle) {
      state_ = State::hold;
    } else if (state_ == State::jog) {
      planner_.clear();
      motor_.slow_down();
    }
  }

  void resume() {
    if (state_ == State::hold && motor_.speed_deg_s() == 0) {
      state_ = planner_.empty() ? State::idle : State::run;
      going_to_.reset();
    }
  }

  std::string state_name() const {
    switch (state_) {
      case State::idle:
        return "Idle";
      case State::run:
        return "Run";
      case State::hold:
        return motor_.speed_deg_s() != 0 ? "Hold:1" : "Hold:0";
      case State::jog:
        return "Jog";
      case State::alarm:
        return "Alarm";
      case State::home:
        return "Home";
    }
    return "Idle";
  }

  // Says the status report; while homing looks for the switch, it comes only at the end.
  void report() {
    if (homing_) {
      report_asked_ = true;
      return;
    }
    const bool machine = (static_cast<int>(settings_.at(10)) & 1) != 0;
    std::array<char, 200> text{};
    std::snprintf(text.data(), text.size(), "<%s|%s:%.3f,0.000,0.000|FS:%.0f,0", state_name().c_str(),
                  machine ? "MPos" : "WPos", machine_deg() - (machine ? 0 : offset_deg_),
                  std::abs(motor_.speed_deg_s()) * 60);
    std::string line = text.data();
    if (reports_to_offset_-- <= 0) {
      reports_to_offset_ = kOffsetEvery - 1;
      std::snprintf(text.data(), text.size(), "|WCO:%.3f,0.000,0.000", offset_deg_);
      line += text.data();
    } else if (reports_to_overrides_-- <= 0) {
      reports_to_overrides_ = kOverridesEvery - 1;
      line += "|Ov:100,100,100";
    }
    say(line + ">");
  }

  void collect(char byte) {
    if (wait_for_reset_) return;
    if (byte != '\n' && byte != '\r') {
      line_ += byte;
      return;
    }
    waiting_.push_back(std::exchange(line_, {}));
    update();
  }

  // Brings all up to the clock's time: the motor, the lines that waited for it, the end of homing.
  void update() override {
    for (;;) {
      motor_.update();
      if (homing_ && !motor_.turning()) finish_homing();
      run_planner();
      if (dwell_until_s_ && planner_.empty() && clock_.monotonic_s() >= *dwell_until_s_) {
        dwell_until_s_.reset();
        say("ok");
      }
      if (waiting_.empty() || dwell_until_s_ || homing_ || planner_.size() >= kPlannerBlocks || wait_for_reset_) return;
      const std::string line = waiting_.front();
      waiting_.pop_front();
      answer(line);
    }
  }

  void run_planner() {
    if (state_ == State::jog && planner_.empty() && !motor_.turning()) state_ = State::idle;
    while (!planner_.empty() && (state_ == State::idle || state_ == State::run || state_ == State::jog)) {
      state_ = planner_.front().jog ? State::jog : State::run;
      const std::size_t joined = joined_blocks();
      const double end_steps = planner_[joined - 1].target_steps;
      if (going_to_ != end_steps) motor_.go_to(end_steps, planner_.front().speed_deg_s);
      going_to_ = end_steps;
      if (motor_.turning()) {
        while (planner_.front().target_steps != end_steps && passed(planner_.front())) planner_.pop_front();
        return;
      }
      planner_.erase(planner_.begin(), planner_.begin() + static_cast<std::ptrdiff_t>(joined));
      going_to_.reset();
      if (planner_.empty()) state_ = State::idle;
    }
  }

  // How many blocks from the first on lead in one direction: the motor runs through them without slowing down.
  std::size_t joined_blocks() const {
    std::size_t joined = 1;
    while (joined < planner_.size() && planner_[0].way_steps() * planner_[joined].way_steps() > 0) ++joined;
    return joined;
  }

  // Whether the motor has left a block that it ran through behind.
  bool passed(const Block& block) const {
    return block.way_steps() * (motor_.counted_steps() - block.target_steps) >= 0;
  }

  void answer(const std::string& line) {
    if (line.size() > kLongestLine) {
      say("error:" + std::to_string(kLineTooLong));
      return;
    }
    const std::optional<int> status = line.starts_with('$') ? system_line(line) : code_line(line, false);
    if (status) say(*status == 0 ? "ok" : "error:" + std::to_string(*status));
  }

  // Does a system command ("$..."). Returns the status code to answer at once; nothing when the answer comes later.
  std::optional<int> system_line(const std::string& line) {
    if (line == "$I") {
      say("[VER:1.1h.20190830:]");
      say("[OPT:" + settings_.options() + "]");
      return 0;
    }
    if (line == "$X") {
      if (state_ == State::alarm) {
        state_ = State::idle;
        say("[MSG:Caution: Unlocked]");
      }
      return 0;
    }
    if (line.starts_with("$J=")) {
      if (state_ == State::alarm) return kLocked;
      return state_ == State::idle || state_ == State::jog ? code_line(line.substr(3), true) : kNotIdle;
    }
    if (state_ != State::idle && state_ != State::alarm) return kNotIdle;
    if (line == "$$") {
      for (const std::string& setting : settings_.lines()) say(setting);
      return 0;
    }
    if (line == "$H" || (line == "$HX" && settings_.homes_single_axis())) return begin_homing();
    if (line == "$#") {
      print_offsets();
      return 0;
    }
    if (line == "$G") {
      say("[GC:" + std::string(modes_.rapid ? "G0" : "G1") + " G54 G17 G21 " + (modes_.incremental ? "G91" : "G90") +
          " G94 M5 M9 T0 F" + std::to_string(std::lround(modes_.feed_deg_min)) + " S0]");
      return 0;
    }
    return settings_.set(line);
  }

  void print_offsets() {
    for (int system = 54; system < 60; ++system) say("[G" + std::to_string(system) + ":0.000,0.000,0.000]");
    say("[G28:0.000,0.000,0.000]");
    say("[G30:0.000,0.000,0.000]");
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "[G92:%.3f,0.000,0.000]", offset_deg_);
    say(text.data());
    say("[TLO:0.000]");
    say("[PRB:0.000,0.000,0.000:0]");
  }

  std::optional<int> begin_homing() {
    if (settings_.at(22) == 0) return kHomingDisabled;
    if (!with_switch_) {
      state_ = State::alarm;
      say("ALARM:9");
      return std::nullopt;
    }
    state_ = State::home;
    homing_ = true;
    motor_.go_to(motor_.counted_at_true_zero(), std::min(settings_.at(25), settings_.at(110)) / 60);
    return std::nullopt;
  }

  void finish_homing() {
    if (report_asked_) {
      homing_ = false;
      report();
      report_asked_ = false;
    }
    homing_ = false;
    state_ = State::idle;
    stand_and_count_from(-settings_.at(27) * settings_.at(100));
    say("ok");
  }

  std::optional<int> code_line(const std::string& line, bool jog) {
    if (state_ == State::alarm) return kLocked;
    const auto parsed = parse_grbl_code(line, jog, modes_);
    if (const auto* status = std::get_if<GrblStatusCode>(&parsed)) return *status;
    const GrblCode& code = std::get<GrblCode>(parsed);
    if (code.dwell_s) {
      dwell_until_s_ = clock_.monotonic_s() + *code.dwell_s;
      return std::nullopt;
    }
    if (code.sets_offset) {
      offset_deg_ = planned_deg() - code.x_deg.value_or(0);
      reports_to_offset_ = 0;
      return 0;
    }
    return code.moves ? plan(code, jog) : std::optional<int>(0);
  }

  double planned_deg() const {
    return planner_.empty() ? machine_deg() : planner_.back().target_steps / settings_.at(100);
  }

  std::optional<int> plan(const GrblCode& code, bool jog) {
    const double base_deg = code.machine ? 0 : code.incremental ? planned_deg() : offset_deg_;
    const double target_deg = base_deg + *code.x_deg;
    if (settings_.at(20) != 0 && (target_deg > 0 || target_deg < -settings_.at(130))) {
      state_ = State::alarm;
      planner_.clear();
      motor_.slow_down();
      say("ALARM:2");
      say("[MSG:Reset to continue]");
      wait_for_reset_ = true;
      return std::nullopt;
    }
    const double limit_deg_s = settings_.at(110) / 60;
    planner_.push_back({.from_steps = std::round(planned_deg() * settings_.at(100)),
                        .target_steps = std::round(target_deg * settings_.at(100)),
                        .speed_deg_s = code.rapid ? limit_deg_s : std::min(limit_deg_s, code.feed_deg_min / 60),
                        .jog = jog});
    return 0;
  }

  Clock& clock_;
  bool with_switch_;
  SimulatedGrblSettings settings_;
  State state_ = State::idle;
  std::string line_;
  std::deque<std::string> waiting_;  // lines received and not yet answered
  std::deque<Block> planner_;
  std::optional<double> going_to_;  // the place to which the motor was sent, in steps
  std::optional<double> dwell_until_s_;
  bool homing_ = false, report_asked_ = false, wait_for_reset_ = false;
  GrblModes modes_;
  double offset_deg_ = 0;
  int reports_to_offset_ = 0, reports_to_overrides_ = 1;
};

}  // namespace

std::unique_ptr<SimulatedFirmware> make_simulated_grbl(SimulatedMotor motor, Clock& clock, bool with_switch) {
  return std::make_unique<SimulatedGrbl>(motor, clock, with_switch);
}

}  // namespace rig
