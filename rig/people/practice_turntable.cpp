#include "rig/people/practice_turntable.h"

#include <utility>

namespace rig {
namespace {

class PracticeTurntable final : public Turntable {
 public:
  PracticeTurntable(std::unique_ptr<Turntable> by_hand, std::unique_ptr<Turntable> simulated)
      : by_hand_(std::move(by_hand)), simulated_(std::move(simulated)) {}

  void home() override {
    by_hand_->home();
    simulated_->home();
  }
  void move_to(double angle_rad) override {
    by_hand_->move_to(angle_rad);
    simulated_->move_to(by_hand_->angle_rad());
  }
  void stop() override { by_hand_->stop(); }
  double angle_rad() override { return by_hand_->angle_rad(); }
  TurntableState state() override { return by_hand_->state(); }

 private:
  std::unique_ptr<Turntable> by_hand_, simulated_;
};

}  // namespace

std::unique_ptr<Turntable> make_practice_turntable(std::unique_ptr<Turntable> by_hand,
                                                   std::unique_ptr<Turntable> simulated) {
  return std::make_unique<PracticeTurntable>(std::move(by_hand), std::move(simulated));
}

}  // namespace rig
