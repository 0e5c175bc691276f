#include "station/bench/guarded_turntable.h"

#include <utility>

#include "station/output/interrupt.h"

namespace station {
namespace {

constexpr int kWatched = 2;

class GuardedTurntable final : public rig::Turntable {
 public:
  explicit GuardedTurntable(std::unique_ptr<rig::Turntable> turntable) : turntable_(std::move(turntable)) {}

  void home() override {
    drive([&] { turntable_->home(); });
  }
  void move_to(double angle_rad) override {
    drive([&] { turntable_->move_to(angle_rad); });
  }
  void stop() override { turntable_->stop(); }
  double angle_rad() override { return turntable_->angle_rad(); }
  rig::TurntableState state() override { return turntable_->state(); }
  void stands_at(double angle_rad) override { turntable_->stands_at(angle_rad); }

 private:
  template <typename Move>
  void drive(const Move& move) {
    if (interrupted())
      throw Interrupted("the platform was asked to stop, so it is not turned any more; start again when it is safe");
    try {
      move();
    } catch (const std::exception& error) {
      if (interrupted()) throw Interrupted(error.what());
      throw;
    }
  }

  std::unique_ptr<rig::Turntable> turntable_;
  StopOnInterrupt emergency_{[this] { turntable_->stop(); }};  // last: its thread ends before the turntable
};

}  // namespace

std::unique_ptr<rig::Turntable> guard_turntable(std::unique_ptr<rig::Turntable> turntable) {
  watch_more_interrupts(kWatched);
  return std::make_unique<GuardedTurntable>(std::move(turntable));
}

}  // namespace station
