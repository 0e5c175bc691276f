#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "rig/simulated/simulated_controller.h"
#include "rig/turntables/reply_text.h"
#include "rig/turntables/stopping.h"
#include "rig/turntables/zaber_reply.h"

namespace rig {
namespace {

constexpr int kDevice = 1, kAxis = 1;
constexpr const char* kHomingSpeed = "limit.approach.maxspeed";
constexpr double kSpeedUnit = 1.6384,
                 kAccelerationUnit = 1.6384e-4;  // of a microstep per second, and per second squared

// A received command. The numbers in front of the words are device, axis and message number.
struct Command {
  int device = 0, axis = 0;
  std::optional<int> message;
  std::vector<std::string> words;
};

class SimulatedZaber final : public SimulatedController {
 public:
  explicit SimulatedZaber(const SimulatedMotor& motor) : SimulatedController(motor) { power_on(); }

 private:
  // A stage says no greeting.
  void start() override {
    line_.clear();
    homed_ = homing_ = stalled_ = interrupted_ = false;
  }

  void take(char byte) override {
    if (byte != '\n' && byte != '\r')
      line_ += byte;
    else if (const auto command = parsed(std::exchange(line_, {})))
      answer(*command);
  }

  void run_into_switch() override {
    motor_.halt();
    stalled_ = true;
  }

  static std::optional<Command> parsed(std::string line) {
    if (!line.starts_with('/')) return std::nullopt;
    line.erase(0, 1);
    if (const std::size_t colon = line.find(':'); colon != std::string::npos) {
      if (line.substr(colon + 1) != zaber_check_sum(line.substr(0, colon))) return std::nullopt;
      line.resize(colon);
    }
    Command command;
    std::istringstream text(line);
    std::string word;
    for (int numbers = 0; text >> word;) {
      const auto number = number_from<int>(word);
      if (number && command.words.empty() && numbers < 3) {
        (numbers == 0 ? command.device : numbers == 1 ? command.axis : command.message.emplace()) = *number;
        ++numbers;
      } else {
        command.words.push_back(word);
      }
    }
    return command;
  }

  void update() override {
    motor_.update();
    if (homing_ && !motor_.turning()) {
      homing_ = false;
      homed_ = true;
      stand_and_count_from(0);
    }
  }

  std::string warning() const { return stalled_ ? "FS" : !homed_ ? "WR" : interrupted_ ? "NI" : "--"; }

  void reply(const Command& command, const std::string& data, bool accepted = true) {
    std::string text = "01 " + std::to_string(command.axis) + " ";
    if (command.message) text += (*command.message < 10 ? "0" : "") + std::to_string(*command.message) + " ";
    say("@" + text + (accepted ? "OK " : "RJ ") + (motor_.turning() ? "BUSY " : "IDLE ") + warning() + " " + data);
  }

  // Answers nothing to a command for another stage of the chain.
  void answer(const Command& command) {
    if (command.device != 0 && command.device != kDevice) return;
    if (command.axis > kAxis)
      reply(command, "BADAXIS", false);
    else if (command.words.empty())
      reply(command, "0");
    else if (command.words[0] == "get")
      get(command);
    else
      act(command);
  }

  void get(const Command& command) {
    const std::string setting = command.words.size() == 2 ? command.words[1] : "";
    if (setting == "pos")
      reply(command, std::to_string(std::llround(motor_.counted_steps())));
    else if (setting == "version")
      reply(command, "7.35");
    else if (setting == "deviceid" || setting == "device.id")
      reply(command, "50935");
    else if (setting == "resolution")
      reply(command, "64");
    else if (setting == "limit.cycle.dist")
      reply(command, std::to_string(std::llround(motor_.steps_per_deg() * 360)));
    else if (setting == "maxspeed")
      reply(command, std::to_string(stored(motor_.full_speed_deg_s())));
    else if (setting == kHomingSpeed)
      reply(command, std::to_string(homing_speed_));
    else if (setting == "accel")
      reply(command,
            std::to_string(std::lround(motor_.acceleration_deg_s2() * motor_.steps_per_deg() * kAccelerationUnit)));
    else
      reply(command, "BADCOMMAND", false);
  }

  // A speed as the stage stores it.
  long stored(double speed_deg_s) const { return std::lround(speed_deg_s * motor_.steps_per_deg() * kSpeedUnit); }

  void set(const Command& command) {
    const auto value = number_from<long>(command.words[2]);
    const bool known = command.words[1] == kHomingSpeed && value && *value > 0;
    if (known) homing_speed_ = *value;
    reply(command, known ? "0" : "BADDATA", known);
  }

  void act(const Command& command) {
    const std::vector<std::string>& words = command.words;
    if (words[0] == "stop" || words[0] == "estop") {
      interrupted_ = motor_.turning();
      homing_ = false;
      words[0] == "stop" ? motor_.slow_down() : motor_.halt();
      reply(command, "0");
    } else if (words[0] == "home" && words.size() == 1) {
      stalled_ = interrupted_ = false;
      homing_ = true;
      motor_.go_to(motor_.counted_at_true_zero(),
                   std::min(static_cast<double>(homing_speed_) / kSpeedUnit / motor_.steps_per_deg(),
                            motor_.full_speed_deg_s()));
      reply(command, "0");
    } else if (words[0] == "set" && words.size() == 3) {
      set(command);
    } else if (words[0] == "move" && (words.size() == 3 || words.size() == 4) &&
               (words[1] == "abs" || words[1] == "rel")) {
      move(command);
    } else {
      reply(command, "BADCOMMAND", false);
    }
  }

  void move(const Command& command) {
    const auto steps = number_from<std::int64_t>(command.words[2]);
    const double base = command.words[1] == "rel" ? motor_.counted_steps() : 0;
    const double target = base + static_cast<double>(steps.value_or(0));
    const auto speed = number_from<double>(command.words.size() == 4 ? command.words[3] : "0");  // 0: the stored one
    if (!steps || !speed || *speed < 0 || (!homed_ && command.words[1] == "abs") ||
        std::abs(target) > motor_.steps_per_deg() * 360 * 100) {
      reply(command, "BADDATA", false);
      return;
    }
    interrupted_ = motor_.turning();
    const double asked_deg_s = *speed / kSpeedUnit / motor_.steps_per_deg();
    motor_.go_to(target, *speed > 0 ? std::min(asked_deg_s, motor_.full_speed_deg_s()) : motor_.full_speed_deg_s());
    reply(command, "0");
  }

  std::string line_;
  long homing_speed_ = stored(stoppable_speed_deg_s(motor_.acceleration_deg_s2()));
  bool homed_ = false, homing_ = false, stalled_ = false, interrupted_ = false;
};

}  // namespace

std::unique_ptr<SimulatedFirmware> make_simulated_zaber(SimulatedMotor motor) {
  return std::make_unique<SimulatedZaber>(motor);
}

}  // namespace rig
