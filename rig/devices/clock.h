// Time as the rig sees it, injected so that simulated runs and tests never wait.
#pragma once

#include <atomic>
#include <string>

namespace rig {

class Clock {
 public:
  virtual ~Clock() = default;
  virtual double monotonic_s() = 0;  // seconds since an arbitrary start
  virtual std::string utc() = 0;     // ISO 8601 with milliseconds, "2026-11-21T10:20:30.123Z"
  virtual void sleep_s(double duration_s) = 0;
};

// The machine's own clock.
class SystemClock final : public Clock {
 public:
  double monotonic_s() override;
  std::string utc() override;
  void sleep_s(double duration_s) override;
};

// A clock that starts at a given UTC time and stands still but for sleep_s(), which advances it in any thread: at once,
// or after `pace` real seconds for each of its own, so that another thread can look on.
class SimulatedClock final : public Clock {
 public:
  explicit SimulatedClock(double utc_start_unix_s, double pace = 0)
      : utc_start_unix_s_(utc_start_unix_s), pace_(pace) {}
  double monotonic_s() override { return elapsed_s_; }
  std::string utc() override;
  void sleep_s(double duration_s) override;

 private:
  double utc_start_unix_s_, pace_;
  std::atomic<double> elapsed_s_ = 0.0;
};

}  // namespace rig
