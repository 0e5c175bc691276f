#include <utility>

#include "rig/simulated/simulated_firmware.h"

namespace rig {
namespace {

class Echo final : public SimulatedFirmware {
 public:
  void power_on() override {}
  void receive(std::string_view bytes) override { said_ += bytes; }
  std::string transmit() override { return std::exchange(said_, {}); }
  void break_down(Breakdown) override {}

 private:
  std::string said_;
};

}  // namespace

std::unique_ptr<SimulatedFirmware> make_echo() {
  return std::make_unique<Echo>();
}

}  // namespace rig
