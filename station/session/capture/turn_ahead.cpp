#include "station/session/capture/turn_ahead.h"

#include <utility>

namespace station {

void TurnAhead::begin(double angle_rad) {
  wait();
  problem_ = nullptr;
  ahead_rad_ = angle_rad;
  way_ = std::async(std::launch::async, [this, angle_rad] { turntable_.move_to(angle_rad); });
}

void TurnAhead::wait() noexcept {
  if (!way_.valid()) return;
  try {
    way_.get();
  } catch (...) {
    problem_ = std::current_exception();
  }
}

void TurnAhead::move_to(double angle_rad) {
  wait();
  const std::optional<double> ahead_rad = std::exchange(ahead_rad_, std::nullopt);
  if (const std::exception_ptr problem = std::exchange(problem_, nullptr)) std::rethrow_exception(problem);
  if (ahead_rad != angle_rad) turntable_.move_to(angle_rad);
}

}  // namespace station
