#include "rig/simulated/simulated_port.h"

#include <algorithm>
#include <mutex>
#include <utility>

namespace rig {
namespace {

constexpr double kLookEveryS = 0.01;
// Bytes that neither protocol uses, with the beginning of a report and a line end among them.
constexpr std::string_view kGarbage = "\xff\xfe\x81<Ru\r\n\xc3o%k";

// Changes the first digit of the position that the answer of either protocol holds.
void garble_position(std::string& reply) {
  std::size_t at = reply.find("Pos:");
  if (at == std::string::npos) at = reply.find("-- ");
  if (at != std::string::npos) at = reply.find_first_of("0123456789", at);
  if (at != std::string::npos) reply[at] = reply[at] == '7' ? '2' : '7';
}

bool is_operation(char byte) {
  return byte == '\n' || byte == '?' || byte == '!' || byte == '~' || byte == '\x18';
}

class FaultyPort final : public SimulatedPort {
 public:
  FaultyPort(std::unique_ptr<SimulatedFirmware> firmware, LineFaultPlan plan)
      : firmware_(std::move(firmware)), plan_(std::move(plan)) {}

  void power_on() override {
    const std::lock_guard hold(mutex_);
    plugged_ = true;
    start();
  }

  void opened() override {
    const std::lock_guard hold(mutex_);
    if (plugged_) start();
  }

  void receive(std::string_view bytes) override {
    const std::lock_guard hold(mutex_);
    for (std::size_t begin = 0; begin < bytes.size() && plugged_;) {
      const auto end = std::find_if(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.end(), is_operation);
      const std::size_t count = static_cast<std::size_t>(end - bytes.begin()) - begin + (end == bytes.end() ? 0 : 1);
      take(bytes.substr(begin, count), end != bytes.end());
      begin += count;
    }
  }

  std::string transmit() override {
    const std::lock_guard hold(mutex_);
    if (!plugged_) return {};
    if (!silent_ && !echoing_) outbox_ += firmware_->transmit();
    const std::size_t count = std::exchange(split_at_, std::string::npos);
    std::string part = outbox_.substr(0, count);
    outbox_.erase(0, count);
    return part;
  }

  void unplug() override {
    const std::lock_guard hold(mutex_);
    plugged_ = false;
  }

  bool plugged() override {
    const std::lock_guard hold(mutex_);
    return plugged_;
  }

  int operations() override {
    const std::lock_guard hold(mutex_);
    return operations_;
  }

 private:
  void start() {
    silent_ = echoing_ = false;
    outbox_.clear();
    held_back_.clear();
    firmware_->transmit();
    firmware_->power_on();
  }

  void take(std::string_view bytes, bool operation) {
    if (echoing_) {
      outbox_ += bytes;
      return;
    }
    outbox_ += silent_ ? std::string() : firmware_->transmit();
    std::vector<LineFault> now;
    if (operation) {
      ++operations_;
      for (const PlannedLineFault& planned : plan_)
        if (planned.at_operation == operations_) now.push_back(planned.fault);
    }
    const auto has = [&](LineFault fault) { return std::ranges::find(now, fault) != now.end(); };
    silent_ = silent_ || has(LineFault::silence);
    if (has(LineFault::unplug)) {
      plugged_ = false;
      return;
    }
    if (has(LineFault::wrong_device)) {
      echoing_ = true;
      outbox_ += bytes;
      return;
    }
    if (silent_) return;
    if (has(LineFault::reset)) firmware_->break_down(Breakdown::reset);
    if (has(LineFault::jam)) firmware_->break_down(Breakdown::jam);
    firmware_->receive(bytes);
    if (has(LineFault::alarm)) firmware_->break_down(Breakdown::alarm);
    answer(firmware_->transmit(), now);
  }

  void answer(std::string reply, const std::vector<LineFault>& now) {
    std::string late;
    for (const LineFault fault : now) {
      switch (fault) {
        case LineFault::lost_reply:
          reply.clear();
          break;
        case LineFault::garbage:
          reply = std::string(kGarbage) + reply;
          break;
        case LineFault::wrong_digit:
          garble_position(reply);
          break;
        case LineFault::glued:
          while (!reply.empty() && (reply.back() == '\n' || reply.back() == '\r')) reply.pop_back();
          break;
        case LineFault::split:
          split_at_ = outbox_.size() + reply.size() / 2;
          break;
        case LineFault::late:
          late = std::exchange(reply, {});
          break;
        case LineFault::repeated:
          reply += reply;
          break;
        default:
          break;
      }
    }
    outbox_ += std::exchange(held_back_, late) + reply;
  }

  std::mutex mutex_;
  std::unique_ptr<SimulatedFirmware> firmware_;
  LineFaultPlan plan_;
  std::string outbox_, held_back_;
  std::size_t split_at_ = std::string::npos;
  int operations_ = 0;
  bool plugged_ = true, silent_ = false, echoing_ = false;
};

class SimulatedLine final : public ByteLine {
 public:
  SimulatedLine(std::shared_ptr<SimulatedPort> port, Clock& clock) : port_(std::move(port)), clock_(clock) {
    port_->opened();
    require_plug();
  }

  std::string read(double timeout_s) override {
    const double until_s = clock_.monotonic_s() + timeout_s;
    for (;;) {
      require_plug();
      std::string bytes = port_->transmit();
      const double left_s = until_s - clock_.monotonic_s();
      if (!bytes.empty() || left_s <= 0) return bytes;
      clock_.sleep_s(std::min(kLookEveryS, left_s));
    }
  }

  void write(std::string_view bytes) override {
    require_plug();
    port_->receive(bytes);
  }

 private:
  void require_plug() const {
    if (!port_->plugged()) {
      throw Unplugged(
          "the turntable was unplugged or switched off; plug it in, put its mark to the front and home it "
          "again");
    }
  }

  std::shared_ptr<SimulatedPort> port_;
  Clock& clock_;
};

}  // namespace

std::shared_ptr<SimulatedPort> make_simulated_port(std::unique_ptr<SimulatedFirmware> firmware, LineFaultPlan plan) {
  return std::make_shared<FaultyPort>(std::move(firmware), std::move(plan));
}

std::unique_ptr<ByteLine> open_simulated_line(std::shared_ptr<SimulatedPort> port, Clock& clock) {
  return std::make_unique<SimulatedLine>(std::move(port), clock);
}

}  // namespace rig
