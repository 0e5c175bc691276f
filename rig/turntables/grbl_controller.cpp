// GRBL 1.1 as a motion controller. Moves are "G53 G1": absolute in machine coordinates whatever the modal state is, so
// the position survives the reset that ends a stop (a work offset would not), and no faster than a stop allows. The
// "ok" of a move only says that it was planned, so nothing is concluded from it: only the reported position tells
// whether the platform has arrived.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "rig/turntables/controllers.h"
#include "rig/turntables/grbl_reply.h"
#include "rig/turntables/grbl_settings.h"
#include "rig/turntables/line_frames.h"

namespace rig {
namespace {

constexpr double kMuteS = 0.3;       // a board that is silent for so long does not hear
constexpr double kQuietS = 0.1;      // a silence of this length: nothing more is coming
constexpr double kHoldTimeoutS = 3;  // from the hold to standing still
constexpr double kLookS = 0.02;      // the wait per look for homing's answer, which may come much later
constexpr double kStandsS = 1;       // a controller that reports for so long that it stands does not look for its home
constexpr char kReset = '\x18';

using Take = std::function<bool(const GrblReply&)>;

template <typename Kind>
bool is(const GrblReply& reply) {
  return std::holds_alternative<Kind>(reply);
}

bool is_garbled_command(int code) {
  return code == 1 || code == 2 || code == 3 || code == 20;
}

class GrblController final : public MotionController, public GrblSettingsPort {
 public:
  // Asks the controller who it is; its settings may be wrong until check_settings().
  GrblController(std::shared_ptr<ByteLine> line, Clock& clock, const ControllerSetup& setup)
      : line_(std::move(line)), clock_(clock), setup_(setup) {
    hold();
    reset();
    identify();
  }

  // From now on an alarm or a banner is an error.
  void check_settings() {
    const GrblSettings found = read_settings();
    require_grbl_settings(found, setup_, firmware_);
    identity_.steps_per_deg = found.at(100);
    boots_locked_ = found.contains(22) && found.at(22) != 0;
    identity_.speed_deg_s = grbl_stoppable_speed_deg_s(found);
    // Positions come with three decimals.
    identity_.reading_tolerance_steps = static_cast<int>(std::floor(0.0005 * found.at(100) + 0.5));
    on_guard_ = true;
  }

  GrblFirmware firmware() override { return firmware_; }

  // Asks again if $100 got lost on the wire.
  GrblSettings read_settings() override {
    GrblSettings found;
    for (int tries = 0; tries < kMostTries && !found.contains(100); ++tries) {
      for (const GrblReply& reply : ask("$$"))
        if (const auto* setting = std::get_if<GrblSetting>(&reply))
          found.insert_or_assign(setting->number, setting->value);
    }
    if (!found.contains(100)) {
      throw std::runtime_error(
          "the turntable does not say its steps per degree ($100); it needs GRBL 1.1, grblHAL or "
          "FluidNC");
    }
    return found;
  }

  void write_setting(int number, double value) override { ask(grbl_setting_line(number, value)); }

  ControllerIdentity identity() override { return identity_; }

  void start_home() override {
    on_guard_ = false;  // an alarm that homing will clear is no error
    const bool locked = ask_status().state == GrblState::alarm;
    if (setup_.home_by == HomeBy::here) {
      identity_.count_lost = identity_.count_lost || (locked && !boots_locked_);
      if (locked) ask("$X");
      on_guard_ = true;
      return;
    }
    on_guard_ = true;
    homings_ = 0;
    begin_homing();
  }

  void start_move(std::int64_t steps) override {
    std::array<char, 80> command{};
    std::snprintf(command.data(), command.size(), "G21 G94 G53 G1 X%.4f F%.1f\n",
                  static_cast<double>(steps) / identity_.steps_per_deg, identity_.speed_deg_s * kSecondsPerMinute);
    begin(command.data());
  }

  MotionStatus status() override {
    if (homing_) return homing_status();
    const GrblStatus status = ask_status();
    return {stopped_ ? Motion::held : motion_of(status.state),
            std::llround(position_deg(status) * identity_.steps_per_deg)};
  }

  // A feed hold, which keeps the position; during homing a reset, because then the firmware obeys nothing else.
  void stop() override {
    stopped_ = true;
    write_stop();
  }

  void clear_stop() override {
    stopped_ = false;  // a stop() from now on needs another clear_stop()
    if (homing_.exchange(false))
      throw PositionLost("the turntable was stopped while it looked for its home; home it again");
    const double until_s = clock_.monotonic_s() + kHoldTimeoutS;
    for (Motion motion = Motion::moving; motion == Motion::moving;) {
      motion = motion_of(ask_status().state);
      if (motion == Motion::moving) {
        if (clock_.monotonic_s() > until_s) {
          line_->write(std::string_view(&kReset, 1));
          throw PositionLost("the turntable did not stop when asked and was switched off the hard way; home it again");
        }
        line_->write("!");
        clock_.sleep_s(kPollS);
      }
    }
    reset();                        // drops the rest of the move
    motion_of(ask_status().state);  // throws on an alarm: the motor was still moving at the reset
  }

 private:
  void write_stop() { line_->write(homing_ ? std::string_view("\x18") : std::string_view("!\x85")); }

  // Nothing turns after a stop. One that another thread wrote just before is written again, because it may have come
  // before this command.
  void begin(std::string_view command) {
    if (stopped_) return;
    line_->write(command);
    if (stopped_) write_stop();
  }

  void begin_homing() {
    home_seen_ = false;
    stands_since_s_.reset();
    homing_ = true;
    ++homings_;
    begin(*grbl_homing_command(setup_, firmware_) + "\n");
  }

  bool listen(double timeout_s, const Take& take) {
    return rig::listen(*line_, frames_, clock_, timeout_s, [&](const std::string& text) {
      const GrblReply reply = parse_grbl_line(text);
      remember(reply);
      return take(reply);
    });
  }

  void remember(const GrblReply& reply) {
    if (const auto* status = std::get_if<GrblStatus>(&reply)) {
      work_offset_deg_ = status->work_offset_deg ? status->work_offset_deg : work_offset_deg_;
      if (status->state == GrblState::home) homing_ = home_seen_ = true;
    } else if (const auto* noise = std::get_if<GrblNoise>(&reply)) {
      noise_ = noise->text;
    } else if (const auto* alarm = std::get_if<GrblAlarm>(&reply)) {
      alarm_code_ = alarm->code;
      identity_.count_lost = true;
      if (on_guard_) throw_alarm();
    } else if (is<GrblBanner>(reply)) {
      alarm_code_.reset();
      if (!on_guard_) return;
      throw PositionLost(
          "the turntable's controller started anew in the middle of its work (its power or USB cable?) and no longer "
          "knows where the platform is; check its supply, then home it");
    }
  }

  [[noreturn]] void throw_alarm() const {
    throw PositionLost("the turntable reports " + grbl_alarm_words(*alarm_code_) + "; then home it");
  }

  // Throws the alarm when there was one, because after some alarms GRBL answers nothing until a reset; else NoReply.
  [[noreturn]] void throw_no_reply(const std::string& message) const {
    if (alarm_code_) throw_alarm();
    throw NoReply(message);
  }

  // Ends what an earlier program left turning, before the reset: the count is kept when the motor stands. A board that
  // says nothing starts anew, or is none.
  void hold() {
    const double until_s = clock_.monotonic_s() + kHoldTimeoutS;
    line_->write("!");
    for (double heard_s = clock_.monotonic_s(); clock_.monotonic_s() < std::min(until_s, heard_s + kMuteS);) {
      std::optional<GrblState> state;
      line_->write("?");
      listen(kPollS, [&](const GrblReply& reply) {
        if (const auto* status = std::get_if<GrblStatus>(&reply)) state = status->state;
        return state.has_value();
      });
      if (!state) continue;
      if (*state != GrblState::run && *state != GrblState::jog && *state != GrblState::hold_moving) return;
      heard_s = clock_.monotonic_s();
      clock_.sleep_s(kPollS);
    }
  }

  // Ends any motion and clears alarms. GRBL keeps its position if the motor stood still.
  void reset() {
    const bool guarded = std::exchange(on_guard_, false);
    frames_.clear();
    noise_.clear();
    std::string banner;
    for (int tries = 0; tries < kMostTries && banner.empty(); ++tries) {
      identity_.repeated += tries > 0;
      // The second try adds a line, so that a device of another kind says something, too.
      line_->write(tries == 0 ? std::string(1, kReset) : std::string(1, kReset) + "\n$I\n");
      listen(setup_.banner_timeout_s / kMostTries, [&](const GrblReply& reply) {
        if (const auto* found = std::get_if<GrblBanner>(&reply)) banner = found->text;
        return !banner.empty();
      });
    }
    if (banner.empty()) {
      throw NoReply(noise_.empty()
                        ? "the turntable was reset and said nothing; switch its power on, and check \"port\" and "
                          "\"baud\" in the rig file (\"threadstation devices\" lists the ports)"
                        : "the device was reset and answered \"" + printable(noise_) +
                              "\", which is not what GRBL says; choose the turntable's port in the rig file "
                              "(\"threadstation devices\" lists the ports) and check its \"baud\"");
    }
    if (identity_.firmware.empty()) identity_.firmware = banner;
    listen(kQuietS, [](const GrblReply&) { return false; });
    homing_ = false;
    on_guard_ = guarded;
  }

  // Sends a line and waits for its ok; returns every reply up to and with it.
  std::vector<GrblReply> ask(const std::string& command) {
    for (int tries = 0; tries < kMostTries; ++tries) {
      identity_.repeated += tries > 0;
      listen(0, [](const GrblReply&) { return false; });  // drops late answers to earlier questions
      std::vector<GrblReply> replies;
      line_->write(command + "\n");
      const bool answered = listen(setup_.reply_timeout_s, [&](const GrblReply& reply) {
        replies.push_back(reply);
        return is<GrblOk>(reply) || is<GrblError>(reply);
      });
      const auto* error = answered ? std::get_if<GrblError>(&replies.back()) : nullptr;
      if (error != nullptr && !is_garbled_command(error->code)) {
        throw std::runtime_error("the turntable was asked \"" + command + "\" and answered " +
                                 grbl_error_words(error->code));
      }
      if (answered && error == nullptr) return replies;
    }
    throw_no_reply("the turntable was asked \"" + command + "\" " + std::to_string(kMostTries) +
                   " times and did not answer; check its cable and its power, then home it");
  }

  // Both lines must have come: the options tell how it homes.
  void identify() {
    for (int tries = 0; tries < kMostTries; ++tries) {
      std::vector<std::string> lines;
      for (const GrblReply& reply : ask("$I"))
        if (const auto* message = std::get_if<GrblMessage>(&reply)) lines.push_back(message->text);
      const auto says = [&](const char* kind) {
        return std::ranges::any_of(lines, [&](const std::string& line) { return line.starts_with(kind); });
      };
      firmware_ = grbl_firmware(identity_.firmware, lines);
      if (says("VER:") && (says("OPT:") || tries + 1 == kMostTries)) return;
    }
    throw std::runtime_error(
        "the device on the turntable's port started like GRBL and did not say its version; it "
        "needs GRBL 1.1, grblHAL or FluidNC");
  }

  GrblStatus ask_status() {
    std::optional<GrblStatus> found;
    for (int tries = 0; tries < kMostTries; ++tries) {
      identity_.repeated += tries > 0;
      listen(0, [](const GrblReply&) { return false; });  // drops late answers, which tell an earlier position
      line_->write("?");
      std::optional<GrblError> refused;
      listen(setup_.reply_timeout_s / kMostTries, [&](const GrblReply& reply) {
        if (const auto* status = std::get_if<GrblStatus>(&reply))
          found = *status;
        else if (const auto* error = std::get_if<GrblError>(&reply); error && !is_garbled_command(error->code))
          refused = *error;
        return found.has_value() || refused.has_value();
      });
      if (refused && on_guard_)
        throw std::runtime_error("the turntable was to turn and answered " + grbl_error_words(refused->code));
      if (found && (found->machine_deg || work_offset_deg_)) return *found;
    }
    throw_no_reply(
        "the turntable was asked where it is and did not answer; its cable may be loose or its power off: check "
        "them, "
        "then home it");
  }

  double position_deg(const GrblStatus& status) const {
    return status.machine_deg ? *status.machine_deg : *status.work_deg + *work_offset_deg_;
  }

  Motion motion_of(GrblState state) const {
    switch (state) {
      case GrblState::idle:
      case GrblState::check:
        return Motion::idle;
      case GrblState::hold:
        return Motion::held;
      case GrblState::alarm:
        throw PositionLost("the turntable is locked by an alarm; see that the platform turns freely, then home it");
      case GrblState::door:
        throw std::runtime_error("the turntable's safety door input is open; close it, then home it");
      case GrblState::sleep:
        throw PositionLost("the turntable's controller sleeps and its motor is off; home it");
      default:
        return Motion::moving;
    }
  }

  // During homing the firmware answers late or not at all; its ok comes at the end. Homing has ended with the first
  // report of "idle" behind that or behind a report of "home": an ok alone may be a late one of something else. When
  // it reports to stand and nothing else, the command or its ok got lost on the wire, and it is told to home again.
  MotionStatus homing_status() {
    if (stopped_) return {Motion::held, 0};
    bool done = false;
    std::optional<GrblError> refused;
    std::optional<GrblStatus> seen;
    listen(kLookS, [&](const GrblReply& reply) {
      home_seen_ = home_seen_ || is<GrblOk>(reply);
      if (const auto* error = std::get_if<GrblError>(&reply)) {
        refused = *error;
      } else if (const auto* status = std::get_if<GrblStatus>(&reply)) {
        seen = *status;
        done = home_seen_ && status->state == GrblState::idle;
      }
      return refused || seen;
    });
    if (refused) {
      homing_ = false;
      throw std::runtime_error("the turntable was asked to home and answered " + grbl_error_words(refused->code));
    }
    if (!done) {
      const bool stands = seen && !home_seen_ && (seen->state == GrblState::idle || seen->state == GrblState::alarm);
      const double now_s = clock_.monotonic_s();
      stands_since_s_ = stands ? std::optional(stands_since_s_.value_or(now_s)) : std::nullopt;
      if (stands && now_s - *stands_since_s_ > kStandsS && homings_ < kMostTries) begin_homing();
      line_->write("?");
      return {Motion::moving, 0};
    }
    homing_ = false;
    return status();
  }

  std::shared_ptr<ByteLine> line_;
  Clock& clock_;
  ControllerSetup setup_;
  ControllerIdentity identity_;
  GrblFirmware firmware_;
  LineFrames frames_;
  std::optional<double> work_offset_deg_;
  std::string noise_;                                   // the last noise heard
  std::optional<int> alarm_code_;                       // since the last reset
  bool on_guard_ = false;                               // true: an alarm or a banner means that the position is lost
  bool boots_locked_ = false;                           // an alarm after a reset is no news
  bool home_seen_ = false;                              // homing has begun
  int homings_ = 0;                                     // how often it was begun
  std::optional<double> stands_since_s_;                // while it homes
  std::atomic<bool> homing_ = false, stopped_ = false;  // stop() comes from other threads
};

}  // namespace

std::unique_ptr<MotionController> connect_grbl(std::shared_ptr<ByteLine> line, Clock& clock,
                                               const ControllerSetup& setup) {
  auto controller = std::make_unique<GrblController>(std::move(line), clock, setup);
  controller->check_settings();
  return controller;
}

std::unique_ptr<GrblSettingsPort> connect_grbl_settings(std::shared_ptr<ByteLine> line, Clock& clock,
                                                        const ControllerSetup& setup) {
  return std::make_unique<GrblController>(std::move(line), clock, setup);
}

}  // namespace rig
