// The platform turns to the next view while the picture of this one is looked at.
#pragma once

#include <exception>
#include <future>
#include <optional>

#include "rig/devices/turntable.h"

namespace station {

// Only one thread may use it. Whoever uses the turntable directly has to wait() first.
class TurnAhead {
 public:
  // `turntable` must outlive it.
  explicit TurnAhead(rig::Turntable& turntable) : turntable_(turntable) {}
  ~TurnAhead() { wait(); }
  TurnAhead(const TurnAhead&) = delete;
  TurnAhead& operator=(const TurnAhead&) = delete;

  // Starts the platform and returns at once.
  void begin(double angle_rad);

  // Returns when the platform stands. What went wrong on the way is kept for move_to.
  void wait() noexcept;

  // Waits; where the platform was turned ahead to this angle, that is all. It turns to any other angle (a picture that
  // did not serve is taken again) now. Errors: those of the turntable, also of the way ahead.
  void move_to(double angle_rad);

 private:
  rig::Turntable& turntable_;
  std::future<void> way_;
  std::optional<double> ahead_rad_;
  std::exception_ptr problem_;
};

}  // namespace station
