// The platform on its way to the next view while the picture of this one is looked at.
#pragma once

#include <exception>
#include <future>
#include <optional>

#include "rig/turntable.h"

namespace station {

// One thread's. Whoever uses the turntable directly has to wait() first.
class TurnAhead {
 public:
  // `turntable` must outlive it.
  explicit TurnAhead(rig::Turntable& turntable) : turntable_(turntable) {}
  ~TurnAhead() { wait(); }
  TurnAhead(const TurnAhead&) = delete;
  TurnAhead& operator=(const TurnAhead&) = delete;

  // Returns at once.
  void begin(double angle_rad);

  // Until the platform stands. What went wrong is kept for move_to.
  void wait() noexcept;

  // To where it has been turned ahead already: nothing more, or the error of the way there. To anywhere else (a picture
  // that did not serve is taken again): as the turntable's. Errors: those of the turntable.
  void move_to(double angle_rad);

 private:
  rig::Turntable& turntable_;
  std::future<void> way_;
  std::optional<double> ahead_rad_;
  std::exception_ptr problem_;
};

}  // namespace station
