#include "tests/support/documented_firmware.h"

#include <algorithm>
#include <stdexcept>

#include "rig/devices/degree.h"
#include "tests/support/documented_grbl.h"

namespace {

constexpr double kAnswersAfterS = 0.0005, kFullSpeedAfterS = 0.2;

// The clock of another, on which a moment can be passed that has not come there yet.
class HastyClock final : public rig::Clock {
 public:
  explicit HastyClock(rig::Clock& clock) : clock_(clock) {}
  double monotonic_s() override { return std::max(clock_.monotonic_s(), least_s_); }
  std::string utc() override { return clock_.utc(); }
  void sleep_s(double duration_s) override { clock_.sleep_s(duration_s); }
  void hasten(double by_s) { least_s_ = monotonic_s() + by_s; }

 private:
  rig::Clock& clock_;
  double least_s_ = 0;
};

class DocumentedFirmware final : public rig::SimulatedFirmware {
 public:
  DocumentedFirmware(rig::SimulatedBench& bench, rig::Clock& clock, bool with_switch, bool answers_at_once)
      : bench_(bench),
        clock_(clock),
        answers_at_once_(answers_at_once),
        board_(clock_, options_for(bench, with_switch)),
        line_(board_.open()) {}

  // Opening its port resets it.
  void power_on() override {
    line_.reset();
    line_ = board_.open();
    turn_bench();
  }
  void receive(std::string_view bytes) override {
    line_->write(bytes);
    if (answers_at_once_) clock_.hasten(kAnswersAfterS);
    turn_bench();
  }
  std::string transmit() override {
    std::string said = line_->read(0);
    turn_bench();
    return said;
  }
  void break_down(rig::Breakdown breakdown) override {
    switch (breakdown) {
      case rig::Breakdown::reset:
        return power_on();
      case rig::Breakdown::alarm:
        return board_.close_end_switch();
      case rig::Breakdown::jam:
        throw std::logic_error("the documented board does not jam");
    }
  }

 private:
  static DocumentedGrblOptions options_for(const rig::SimulatedBench& bench, bool with_switch) {
    DocumentedGrblOptions options;
    options.homing = DocumentedGrblOptions::Homing::z_first;
    options.homes_single_axis = true;
    options.stands_at_deg = bench.state().platform_angle_rad / rig::kDegree;
    options.eeprom = documented_turntable_settings();
    const double speed_deg_s = bench.truth().turntable.speed_rad_s / rig::kDegree;
    options.eeprom[110] = speed_deg_s * 60;
    options.eeprom[120] = speed_deg_s / kFullSpeedAfterS;
    // It homes in negative direction until the last step of the switch closes, and pulls off.
    constexpr double kPullOffDeg = 1;
    options.eeprom[23] = 1;
    options.eeprom[27] = kPullOffDeg;
    options.switch_deg = 1 / options.steps_per_deg - kPullOffDeg - options.switch_width_deg;
    if (!with_switch) {
      options.switch_deg.reset();
      options.eeprom[22] = 0;
    }
    return options;
  }

  void turn_bench() { bench_.turn_platform(board_.platform_deg() * rig::kDegree); }

  rig::SimulatedBench& bench_;
  HastyClock clock_;
  bool answers_at_once_;
  DocumentedGrbl board_;
  std::unique_ptr<rig::ByteLine> line_;
};

}  // namespace

std::unique_ptr<rig::SimulatedFirmware> make_documented_firmware(rig::SimulatedBench& bench, rig::Clock& clock,
                                                                 bool with_switch, bool answers_at_once) {
  return std::make_unique<DocumentedFirmware>(bench, clock, with_switch, answers_at_once);
}
