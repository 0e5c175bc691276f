// A Zaber rotary stage as a motion controller, in the Zaber ASCII protocol. Every question carries a number that its
// answer repeats, so that late and repeated answers are recognised, and a check sum, so that the stage does not obey a
// garbled command.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include "rig/turntables/controllers.h"
#include "rig/turntables/line_frames.h"
#include "rig/turntables/reply_text.h"
#include "rig/turntables/stopping.h"
#include "rig/turntables/zaber_reply.h"

namespace rig {
namespace {

constexpr double kStopTimeoutS = 3;  // from the stop to standing still
constexpr double kDegreesPerTurn = 360;
// The stage's units: 1.6384 in "maxspeed" is a microstep per second, and 1 in "accel" is 10000 / 1.6384 of them per
// second squared.
constexpr double kSpeedUnit = 1.6384, kAccelerationUnit = 1.6384e-4;
constexpr double kTakesSpeed = 7.25;  // from this firmware on a move may be given its own speed

class ZaberController final : public MotionController {
 public:
  ZaberController(std::shared_ptr<ByteLine> line, Clock& clock, const ControllerSetup& setup)
      : line_(std::move(line)), clock_(clock), setup_(setup) {
    if (setup.home_by != HomeBy::home_switch)
      throw std::runtime_error("a Zaber stage finds its home by itself; write \"home\": \"switch\" in the rig file");
    identify();
    ask("stop");  // the stage may still be turning from an earlier run
    wait_to_stand();
  }

  ControllerIdentity identity() override { return identity_; }

  void start_home() override {
    homing_ = true;
    begin("home");
  }

  void start_move(std::int64_t steps) override { begin("move abs " + std::to_string(steps) + move_speed_); }

  MotionStatus status() override {
    const ZaberReply reply = ask("get pos");
    const bool held = stopped_;
    if (homing_ && !reply.busy && !held) homing_ = false;
    const bool fault = reply.warning.starts_with('F') || reply.warning == "WS";
    const bool lost = reply.warning == "WR" || reply.warning == "WH" || reply.warning == "WM";
    if (fault || (lost && !homing_)) throw PositionLost("the turntable reports " + zaber_warning_words(reply.warning));
    const auto steps = number_from<std::int64_t>(reply.data);
    if (!steps) {
      throw std::runtime_error("the turntable was asked for its position and answered \"" + printable(reply.data) +
                               "\"; check \"axis\" in the rig file");
    }
    return {held ? Motion::held : reply.busy ? Motion::moving : Motion::idle, *steps};
  }

  void stop() override {
    stopped_ = true;
    write_stop();
  }

  void clear_stop() override {
    stopped_ = false;  // a stop() from now on needs another clear_stop()
    ask("stop");       // stop() did not wait for an answer
    wait_to_stand();
    if (std::exchange(homing_, false))
      throw PositionLost("the turntable was stopped while it looked for its home; home it again");
  }

 private:
  void write_stop() { line_->write(framed("stop", std::nullopt)); }

  std::string framed(const std::string& command, std::optional<int> message) const {
    std::string text = std::to_string(setup_.zaber_device) + " " + std::to_string(setup_.zaber_axis) + " ";
    if (message) text += (*message < 10 ? "0" : "") + std::to_string(*message) + " ";
    text += command;
    return "/" + text + ":" + zaber_check_sum(text) + "\n";
  }

  // The answer that carries the question's number and comes from the stage that was asked. The stage forgets a stop
  // with the next move, so until clear_stop() a stop is written again behind every question.
  std::optional<ZaberReply> exchange(const std::string& command, double timeout_s) {
    const int message = message_;
    message_ = (message_ + 1) % 100;
    std::optional<ZaberReply> found;
    line_->write(framed(command, message));
    if (stopped_) write_stop();
    listen(*line_, frames_, clock_, timeout_s, [&](const std::string& text) {
      const auto reply = parse_zaber_line(text);
      if (!reply)
        noise_ = text;
      else if (reply->message == message && reply->device == setup_.zaber_device)
        found = reply;
      return found.has_value();
    });
    return found;
  }

  // Repeats a question that gets no answer. Moves are absolute, so repeating them does no harm. Nothing when `turns`
  // and a stop was asked for: what begins a motion is not written after it, and status() says "held".
  std::optional<ZaberReply> try_to_ask(const std::string& command, bool turns) {
    for (int tries = 0; tries < kMostTries; ++tries) {
      if (turns && stopped_) return std::nullopt;
      identity_.repeated += tries > 0;
      if (auto reply = exchange(command, setup_.reply_timeout_s / kMostTries)) return *reply;
    }
    if (identity_.firmware.empty() && !noise_.empty()) {
      throw NoReply("the device was asked for a Zaber stage's version and answered \"" + printable(noise_) +
                    "\"; choose the turntable's port in the rig file (\"threadstation devices\" lists the ports) and "
                    "check its \"baud\"");
    }
    throw NoReply("the turntable was asked \"" + command + "\" " + std::to_string(kMostTries) +
                  " times and did not answer; check its cable and its power, and \"device\" in the rig file, then home "
                  "it");
  }

  ZaberReply ask(const std::string& command) { return accepted(command, *try_to_ask(command, false)); }

  void begin(const std::string& command) {
    if (const auto reply = try_to_ask(command, true)) accepted(command, *reply);
  }

  static const ZaberReply& accepted(const std::string& command, const ZaberReply& reply) {
    if (!reply.accepted && (reply.warning == "WR" || reply.warning == "WH")) {
      throw PositionLost("the turntable was asked \"" + command + "\" and reports " +
                         zaber_warning_words(reply.warning));
    }
    if (!reply.accepted) {
      throw std::runtime_error("the turntable was asked \"" + command + "\" and rejected it, " +
                               zaber_rejection_words(reply.data));
    }
    return reply;
  }

  double ask_number(const std::string& setting) { return number_of(setting, ask("get " + setting)); }

  static double number_of(const std::string& setting, const ZaberReply& reply) {
    const auto value = number_from<double>(reply.data);
    if (!value) {
      throw std::runtime_error("the turntable was asked for its " + setting + " and answered \"" +
                               printable(reply.data) + "\"; check \"axis\" in the rig file");
    }
    return *value;
  }

  void identify() {
    const std::string version = ask("get version").data;
    identity_.firmware =
        "Zaber firmware " + version + ", device " + std::to_string(std::lround(ask_number("deviceid")));
    const double resolution = ask_number("resolution");
    if (resolution != setup_.zaber_resolution) {
      throw std::runtime_error("the turntable is set to a resolution of " + std::to_string(std::lround(resolution)) +
                               " microsteps per step and the rig file says " + std::to_string(setup_.zaber_resolution) +
                               "; send \"set resolution " + std::to_string(setup_.zaber_resolution) +
                               "\", or change the rig file");
    }
    identity_.steps_per_deg = ask_number("limit.cycle.dist") / kDegreesPerTurn;
    const bool known = setup_.steps_per_deg > 0;
    if (known && !(std::abs(identity_.steps_per_deg / setup_.steps_per_deg - 1) <= kSameRatio)) {
      throw std::runtime_error("the turntable has " + std::to_string(identity_.steps_per_deg) +
                               " microsteps per degree (limit.cycle.dist / 360) and the rig file says " +
                               std::to_string(setup_.steps_per_deg) + "; correct \"steps_per_deg\" in the rig file");
    }
    limit_speed(number_from<double>(version).value_or(0));
  }

  // Older firmware moves at the speed that is stored in the stage, and every stage homes at one: neither is changed
  // behind its owner's back.
  void limit_speed(double version) {
    const double unit = kSpeedUnit * identity_.steps_per_deg;
    const double stored_deg_s = ask_number("maxspeed") / unit;
    const double most_deg_s =
        stoppable_speed_deg_s(ask_number("accel") / (kAccelerationUnit * identity_.steps_per_deg));
    identity_.speed_deg_s = std::min(stored_deg_s, most_deg_s);
    const std::string most = std::to_string(static_cast<long>(most_deg_s * unit));
    if (stored_deg_s <= most_deg_s) return;
    const auto refuse = [&](const std::string& does, double speed_deg_s, const std::string& setting) {
      throw std::runtime_error("the turntable " + does + " at " + std::to_string(speed_deg_s) +
                               " deg/s, too fast to be stopped within 5 degrees; send \"set " + setting + " " + most +
                               "\" (" + std::to_string(most_deg_s) + " deg/s)");
    };
    if (version < kTakesSpeed) refuse("turns", stored_deg_s, "maxspeed");
    // Some stages do not let everybody see the speed at which they home; it is maxspeed at most.
    const std::string setting = "limit.approach.maxspeed";
    const ZaberReply approach = *try_to_ask("get " + setting, false);
    const double homes_deg_s =
        approach.accepted ? std::min(stored_deg_s, number_of(setting, approach) / unit) : stored_deg_s;
    if (homes_deg_s > most_deg_s * (1 + kSameRatio))
      refuse("looks for its home", homes_deg_s, approach.accepted ? setting : "maxspeed");
    move_speed_ = " " + most;
  }

  void wait_to_stand() {
    const double until_s = clock_.monotonic_s() + kStopTimeoutS;
    while (ask("get pos").busy) {
      if (clock_.monotonic_s() > until_s)
        throw std::runtime_error("the turntable was stopped and goes on turning; switch its power off");
      clock_.sleep_s(kPollS);
    }
  }

  std::shared_ptr<ByteLine> line_;
  Clock& clock_;
  ControllerSetup setup_;
  ControllerIdentity identity_;
  LineFrames frames_;
  std::string noise_;       // the last noise heard
  std::string move_speed_;  // behind a move's place; empty: the stage's own is slow enough
  int message_ = 0;
  bool homing_ = false;
  std::atomic<bool> stopped_ = false;  // stop() comes from other threads
};

}  // namespace

std::unique_ptr<MotionController> connect_zaber(std::shared_ptr<ByteLine> line, Clock& clock,
                                                const ControllerSetup& setup) {
  return std::make_unique<ZaberController>(std::move(line), clock, setup);
}

}  // namespace rig
